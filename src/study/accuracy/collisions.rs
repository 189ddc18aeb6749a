//! How many collisions a walk is expected to have.

use serde::Serialize;

use super::effects::coefficients;
use crate::medium::{Entry, Medium, PlaneParallel};
use crate::scene::{Scene, Surface};

/// Collisions of a photon that enters a material.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ExpectedCollisions {
    /// Name of the material.
    pub material: String,
    /// Mean free path 1/σ_t of each channel, m.
    pub mean_free_path: [f64; 3],
    /// Mean number of collisions of a photon that enters a half-space, by channel; `None` where nothing is absorbed, as
    /// it is infinite there.
    pub collisions: [Option<f64>; 3],
}

/// What is expected in each translucent material of `scene` that is the same all over.
///
/// Each collision absorbs the share 1 − ω, so that a photon which is absorbed with probability P has P/(1 − ω) of them in the
/// mean, in any body. P is that of a half-space in even light: a thin body has fewer.
pub fn expected(scene: &Scene) -> Vec<ExpectedCollisions> {
    let of_material = |material: &crate::scene::Material| {
        let Surface::Translucent { ior, medium, .. } = &material.surface else { return None };
        let Medium { sigma_a, sigma_s, g } = coefficients(medium, *ior)?;
        let layer = PlaneParallel::new(f64::from(*ior), f64::from(g));
        let [sigma_a, sigma_s] = [sigma_a, sigma_s].map(|sigma| sigma.0.map(f64::from));
        let extinction = [0, 1, 2].map(|c| sigma_a[c] + sigma_s[c]);
        let collisions = [0, 1, 2].map(|c| {
            let share = sigma_a[c] / extinction[c];
            (share > 0.0).then(|| (1.0 - layer.half_space(share).albedo(Entry::Diffuse)) / share)
        });
        Some(ExpectedCollisions {
            material: material.name.clone(),
            mean_free_path: extinction.map(|sigma| 1.0 / sigma),
            collisions,
        })
    };
    scene.materials.iter().filter_map(of_material).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::radiometry::Rgb;
    use crate::scene::{Material, ScatteringInput};

    #[test]
    fn a_medium_that_only_absorbs_has_one_collision() {
        let medium = |sigma_a: Rgb, sigma_s: Rgb| Scene {
            materials: vec![Material {
                surface: Surface::Translucent {
                    ior: 1.0,
                    roughness: 0.0,
                    medium: ScatteringInput::Coefficients { sigma_a, sigma_s, g: 0.0 },
                },
                ..Material::default()
            }],
            ..Scene::default()
        };
        let found = &expected(&medium(Rgb::new(4.0, 1.0, 0.0), Rgb::new(0.0, 1.0, 5.0)))[0];
        assert_eq!(found.mean_free_path, [0.25, 0.5, 0.2]);
        let [absorbing, even, white] = found.collisions;
        // The quadrature is good to 10⁻⁶.
        assert!((absorbing.unwrap() - 1.0).abs() < 1e-6);
        // At most 1/(1 − ω) = 2.
        assert!((1.0..2.0).contains(&even.unwrap()));
        assert_eq!(white, None);
    }
}
