//! Measured scattering materials from the literature.

use crate::radiometry::Rgb;

/// Coefficients of a real material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeasuredMaterial {
    /// Name, unique up to case and punctuation.
    pub name: &'static str,
    /// Who measured it.
    pub source: &'static str,
    /// Absorption coefficient, 1/m.
    pub sigma_a: Rgb,
    /// Reduced scattering coefficient σ_s(1 − g), 1/m.
    pub sigma_s_reduced: Rgb,
    /// Index of refraction.
    pub ior: f32,
}

/// No measured material has the name asked for.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("there is no measured material `{name}`{}", suggestion.map(|s| format!("; did you mean `{s}`?")).unwrap_or_default())]
pub struct UnknownMaterial {
    /// The name asked for.
    pub name: String,
    /// The most similar name, if one is similar.
    pub suggestion: Option<&'static str>,
}

/// The measured material called `name`; case, spaces and punctuation do not matter.
pub fn measured_material(name: &str) -> Result<&'static MeasuredMaterial, UnknownMaterial> {
    let wanted = essence(name);
    if let Some(material) = MEASURED_MATERIALS.iter().find(|m| essence(m.name) == wanted) {
        return Ok(material);
    }
    let similarity = |m: &MeasuredMaterial| strsim::jaro_winkler(&essence(m.name), &wanted);
    let nearest = MEASURED_MATERIALS.iter().max_by(|a, b| similarity(a).total_cmp(&similarity(b)));
    let suggestion = nearest.filter(|m| similarity(m) > 0.8).map(|m| m.name);
    Err(UnknownMaterial { name: name.to_owned(), suggestion })
}

/// What is left of a name without case, spaces and punctuation.
fn essence(name: &str) -> String {
    name.chars().filter(|c| c.is_alphanumeric()).flat_map(char::to_lowercase).collect()
}

/// Jensen, Marschner, Levoy, Hanrahan 2001, "A Practical Model for Subsurface Light Transport",
/// figure 5, per millimetre there.
const fn jensen(name: &'static str, absorption: [f32; 3], reduced: [f32; 3], ior: f32) -> MeasuredMaterial {
    MeasuredMaterial {
        name,
        source: "Jensen et al. 2001",
        sigma_a: per_millimetre(absorption),
        sigma_s_reduced: per_millimetre(reduced),
        ior,
    }
}

/// Narasimhan et al. 2006, "Acquiring Scattering Properties of Participating Media by Dilution", at
/// the dilutions measured there, per millimetre, scattering reduced by their g. The index of
/// refraction was not measured; all are solutions in water, so it is water's.
const fn narasimhan(name: &'static str, absorption: [f32; 3], reduced: [f32; 3]) -> MeasuredMaterial {
    MeasuredMaterial {
        name,
        source: "Narasimhan et al. 2006",
        sigma_a: per_millimetre(absorption),
        sigma_s_reduced: per_millimetre(reduced),
        ior: 1.33,
    }
}

/// From 1/mm to 1/m.
const fn per_millimetre([r, g, b]: [f32; 3]) -> Rgb {
    Rgb::new(1000.0 * r, 1000.0 * g, 1000.0 * b)
}

/// All measured materials: name, absorption and reduced scattering (1/mm as published), index.
#[rustfmt::skip]
pub static MEASURED_MATERIALS: &[MeasuredMaterial] = &[
    jensen("Apple", [0.003, 0.0034, 0.046], [2.29, 2.39, 1.97], 1.3),
    jensen("Chicken1", [0.015, 0.077, 0.19], [0.15, 0.21, 0.38], 1.3),
    jensen("Chicken2", [0.018, 0.088, 0.2], [0.19, 0.25, 0.32], 1.3),
    jensen("Cream", [0.0002, 0.0028, 0.0163], [7.38, 5.47, 3.15], 1.3),
    jensen("Ketchup", [0.061, 0.97, 1.45], [0.18, 0.07, 0.03], 1.3),
    jensen("Marble", [0.0021, 0.0041, 0.0071], [2.19, 2.62, 3.0], 1.5),
    jensen("Potato", [0.0024, 0.009, 0.12], [0.68, 0.7, 0.55], 1.3),
    jensen("Skim Milk", [0.0014, 0.0025, 0.0142], [0.7, 1.22, 1.9], 1.3),
    jensen("Skin1", [0.032, 0.17, 0.48], [0.74, 0.88, 1.01], 1.3),
    jensen("Skin2", [0.013, 0.07, 0.145], [1.09, 1.59, 1.79], 1.3),
    jensen("Spectralon", [0.0, 0.0, 0.0], [11.6, 20.4, 14.9], 1.3),
    jensen("Whole Milk", [0.0011, 0.0024, 0.014], [2.55, 3.21, 3.77], 1.3),
    narasimhan("Lowfat Milk", [0.002875, 0.00575, 0.0115], [0.89187, 1.5136, 2.532]),
    narasimhan("Reduced Milk", [0.0025556, 0.0051111, 0.012778], [2.4858, 3.1669, 4.5214]),
    narasimhan("Regular Milk", [0.0015333, 0.0046, 0.019933], [4.5513, 5.8294, 7.136]),
    narasimhan("Espresso", [4.7984, 6.5751, 8.8493], [0.72378, 0.84557, 1.0247]),
    narasimhan("Mint Mocha Coffee", [3.772, 5.8228, 7.82], [0.31602, 0.38538, 0.48131]),
    narasimhan("Lowfat Soy Milk", [0.0014375, 0.0071875, 0.035937], [0.30576, 0.34233, 0.61664]),
    narasimhan("Regular Soy Milk", [0.0019167, 0.0095833, 0.065167], [0.59223, 0.73866, 1.4693]),
    narasimhan("Lowfat Chocolate Milk", [0.0115, 0.0368, 0.1564], [0.64925, 0.83916, 1.1057]),
    narasimhan("Regular Chocolate Milk", [0.010063, 0.043125, 0.14375], [1.4585, 2.1289, 2.9527]),
    narasimhan("Coke", [0.10014, 0.16503, 0.2468], [8.9053e-05, 8.372e-05, 0.0]),
    narasimhan("Pepsi", [0.091641, 0.14158, 0.20729], [6.1697e-05, 4.2564e-05, 0.0]),
    narasimhan("Sprite", [0.001886, 0.0018308, 0.0020025], [6.0306e-06, 6.4139e-06, 6.5504e-06]),
    narasimhan("Gatorade", [0.024794, 0.019289, 0.008878], [0.0024574, 0.003007, 0.0037325]),
    narasimhan("Chardonnay", [0.010782, 0.011855, 0.023997], [1.7982e-05, 1.3758e-05, 1.2023e-05]),
    narasimhan("White Zinfandel", [0.012072, 0.016184, 0.019843], [1.7501e-05, 1.9069e-05, 1.288e-05]),
    narasimhan("Merlot", [0.11632, 0.25191, 0.29434], [2.1129e-05, 0.0, 0.0]),
    narasimhan("Budweiser Beer", [0.011492, 0.024911, 0.057786], [2.4356e-05, 2.4079e-05, 1.0564e-05]),
    narasimhan("Coors Light Beer", [0.006164, 0.013984, 0.034983], [5.0922e-05, 4.301e-05, 0.0]),
    narasimhan("Clorox", [0.0033542, 0.014892, 0.026297], [0.0024035, 0.0031373, 0.003991]),
    narasimhan("Apple Juice", [0.012957, 0.023741, 0.052184], [0.00013612, 0.00015836, 0.000227]),
    narasimhan("Cranberry Juice", [0.039437, 0.094223, 0.12426], [0.00010402, 0.00011646, 7.8139e-05]),
    narasimhan("Grape Juice", [0.10404, 0.23958, 0.29325], [5.382e-05, 0.0, 0.0]),
    narasimhan("Ruby Grapefruit Juice", [0.085867, 0.18314, 0.25262], [0.011002, 0.010927, 0.011036]),
    narasimhan("White Grapefruit Juice", [0.0138, 0.018831, 0.056781], [0.22826, 0.23998, 0.32748]),
    narasimhan("Shampoo", [0.014107, 0.045693, 0.061717], [0.0007176, 0.0008303, 0.0009016]),
    narasimhan("Strawberry Shampoo", [0.01449, 0.05796, 0.075823], [0.00015671, 0.00015947, 1.518e-05]),
    narasimhan("Head & Shoulders Shampoo", [0.084621, 0.15688, 0.20365], [0.023805, 0.028804, 0.034306]),
    narasimhan("Lemon Tea Powder", [2.4288, 4.5757, 7.2127], [0.040224, 0.045264, 0.051081]),
    narasimhan("Orange Powder", [0.001449, 0.003441, 0.007863], [0.00015617, 0.00017482, 0.0001762]),
    narasimhan("Pink Lemonade Powder", [0.001165, 0.002366, 0.003195], [0.00012103, 0.00013073, 0.00012528]),
    narasimhan("Cappuccino Powder", [35.844, 49.547, 61.084], [1.8436, 2.5851, 2.1662]),
    narasimhan("Salt Powder", [0.28415, 0.3257, 0.34148], [0.027333, 0.032451, 0.031979]),
    narasimhan("Sugar Powder", [0.012638, 0.031051, 0.050124], [0.00022272, 0.00025513, 0.000271]),
    narasimhan("Suisse Mocha Powder", [17.502, 27.004, 35.433], [2.7979, 3.5452, 4.3365]),
    narasimhan("Pacific Ocean Surface Water", [0.031845, 0.031324, 0.030147], [0.0001764, 0.00032095, 0.00019617]),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_found_however_they_are_written() {
        for name in ["Skim Milk", "skimmilk", "SKIM-MILK", "skim_milk"] {
            assert_eq!(measured_material(name).map(|m| m.name), Ok("Skim Milk"));
        }
        assert_eq!(measured_material("head and").unwrap_err().name, "head and");
        let misspelt = measured_material("marbel").unwrap_err();
        assert_eq!(misspelt.suggestion, Some("Marble"));
        assert!(misspelt.to_string().contains("did you mean `Marble`?"));
        assert_eq!(measured_material("xyzzy").unwrap_err().suggestion, None);
    }

    #[test]
    fn marble_has_the_published_coefficients_in_metres() {
        let marble = measured_material("marble").unwrap();
        assert_eq!(marble.sigma_a, Rgb::new(2.1, 4.1, 7.1));
        assert_eq!(marble.sigma_s_reduced, Rgb::new(2190.0, 2620.0, 3000.0));
        assert_eq!((marble.ior, marble.source), (1.5, "Jensen et al. 2001"));
    }

    #[test]
    fn the_table_is_physical_and_its_names_are_unique() {
        let mut names = std::collections::HashSet::new();
        for m in MEASURED_MATERIALS {
            assert!(names.insert(essence(m.name)), "{}", m.name);
            assert!(m.sigma_a.min_component() >= 0.0 && m.sigma_s_reduced.min_component() >= 0.0);
            assert!((m.sigma_a + m.sigma_s_reduced).min_component() > 0.0, "{}", m.name);
            assert!(m.ior >= 1.0);
        }
    }
}
