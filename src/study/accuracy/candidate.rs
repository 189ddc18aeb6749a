//! What is compared: methods, with the diffusion profile where they have one.

use crate::diffusion::ProfileKind;
use crate::scene::{Material, Method, ProfileChoice, Scene, Surface};
use crate::study::plot::Style;
use crate::study::profile::ModelChoice;
use crate::study::profile::figures::style;
use crate::transport::RenderOptions;

/// A method and the profile that it uses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Candidate {
    /// How light under the surface is computed.
    pub method: Method,
    /// The diffusion profile; `auto` where the method has none.
    pub profile: ProfileChoice,
    /// Whether the walk takes a similar isotropic medium for an anisotropic one far from surfaces.
    pub similarity: bool,
}

const fn bssrdf(profile: ProfileChoice) -> Candidate {
    Candidate { profile, ..without_profile(Method::Bssrdf) }
}

const fn without_profile(method: Method) -> Candidate {
    Candidate { method, profile: ProfileChoice::Auto, similarity: false }
}

impl Candidate {
    /// Light leaves where it entered.
    pub const DIFFUSE: Self = without_profile(Method::Diffuse);
    /// The area integral with the profile that is the truth on a plane.
    pub const TABULATED: Self = bssrdf(ProfileChoice::Tabulated);
    /// The area integral with the profile that knows the direction of entry.
    pub const DIRECTIONAL: Self = bssrdf(ProfileChoice::DirectionalDipole);
    /// The random walk.
    pub const WALK: Self = without_profile(Method::Walk);
    /// The random walk that takes isotropic scattering for anisotropic far from surfaces.
    pub const SIMILAR_WALK: Self = Self { similarity: true, ..Self::WALK };

    /// All there are, cheapest first.
    pub const ALL: [Self; 9] = [
        Self::DIFFUSE,
        Self::TABULATED,
        bssrdf(ProfileChoice::PhotonBeam),
        bssrdf(ProfileChoice::NormalizedDiffusion),
        Self::DIRECTIONAL,
        bssrdf(ProfileChoice::BetterDipole),
        bssrdf(ProfileChoice::Dipole),
        Self::SIMILAR_WALK,
        Self::WALK,
    ];

    /// How `scene` is rendered by it.
    pub fn options(self, scene: &Scene) -> RenderOptions {
        let Self { method, profile, similarity } = self;
        RenderOptions { method, profile, similarity, ..RenderOptions::of(scene, 0) }
    }

    /// Name of the method, as `--methods` takes it.
    pub fn method_name(self) -> &'static str {
        if self.similarity { "walk-similarity" } else { self.method.name() }
    }

    /// Name of the profile, where there is one.
    pub fn profile_name(self) -> Option<&'static str> {
        (self.method == Method::Bssrdf).then(|| self.profile.name())
    }

    /// A short name, also of files.
    pub fn name(self) -> String {
        match self.profile_name() {
            Some(profile) => format!("{}-{profile}", self.method_name()),
            None => self.method_name().into(),
        }
    }

    /// In a sentence, after "use".
    pub fn in_words(self) -> String {
        match (self.method, self.profile_name()) {
            (Method::Walk, _) if self.similarity => "the walk with --similarity".into(),
            (Method::Walk, _) => "the walk".into(),
            (_, Some(profile)) => format!("{} with the profile {profile}", self.method_name()),
            _ => self.method_name().into(),
        }
    }

    /// Whether it differs from all others on `scene`: a walk takes a similar medium for none that scatters isotropically.
    pub fn is_of_its_own_in(self, scene: &Scene) -> bool {
        let is_anisotropic = |material: &Material| match &material.surface {
            Surface::Translucent { medium, .. } => medium.g() != 0.0,
            _ => false,
        };
        !self.similarity || scene.materials.iter().any(is_anisotropic)
    }

    /// Where it stands in [`Self::ALL`].
    pub fn index(self) -> usize {
        Self::ALL.iter().position(|&other| other == self).unwrap_or(Self::ALL.len())
    }

    /// How its line looks: that of its profile in every study.
    pub fn style(self) -> Style {
        match (self.method, self.profile.kind()) {
            (Method::Walk, _) if self.similarity => Style { color: [0x6b, 0x4f, 0x2a], dashes: "8 3" },
            (Method::Walk, _) => Style { color: [0x1a, 0x1a, 0x1a], dashes: "" },
            (Method::Diffuse, _) => Style { color: [0x88, 0x88, 0x88], dashes: "2 4" },
            (_, Some(ProfileKind::Model(kind))) => style(ModelChoice::Analytic(kind)),
            _ => style(ModelChoice::Tabulated),
        }
    }
}

/// The candidates that `names` ask for, each once and in the order of [`Candidate::ALL`]; all for none. A name is
/// `diffuse`, `walk`, `walk-similarity`, that of a profile, or `bssrdf` for all profiles.
///
/// # Errors
/// What is wrong with a name.
pub fn candidates(names: &[String]) -> Result<Vec<Candidate>, String> {
    let asked = |name: &str, candidate: &Candidate| {
        let profile = candidate.profile_name();
        name == candidate.name()
            || profile.is_some_and(|profile| name == profile || name == candidate.method_name())
    };
    for name in names {
        if !Candidate::ALL.iter().any(|candidate| asked(name, candidate)) {
            return Err(unknown(name));
        }
    }
    let wanted = |candidate: &Candidate| names.is_empty() || names.iter().any(|name| asked(name, candidate));
    Ok(Candidate::ALL.into_iter().filter(wanted).collect())
}

fn unknown(name: &str) -> String {
    let profiles: Vec<_> = Candidate::ALL.iter().filter_map(|candidate| candidate.profile_name()).collect();
    format!(
        "--methods: there is no \"{name}\"; known are diffuse, walk, walk-similarity, bssrdf (with every profile), and for one profile {}",
        profiles.join(", ")
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::radiometry::Rgb;
    use crate::scene::ScatteringInput;

    #[test]
    fn names_choose() {
        let chosen = |names: &[&str]| {
            candidates(&names.iter().map(ToString::to_string).collect::<Vec<_>>())
                .map(|found| found.iter().map(|candidate| candidate.name()).collect::<Vec<_>>())
        };
        assert_eq!(chosen(&[]).unwrap().len(), 9);
        assert_eq!(chosen(&["walk", "tabulated", "walk"]).unwrap(), ["bssrdf-tabulated", "walk"]);
        assert_eq!(chosen(&["walk-similarity"]).unwrap(), ["walk-similarity"]);
        assert_eq!(chosen(&["bssrdf"]).unwrap().len(), 6);
        assert!(chosen(&["auto"]).unwrap_err().contains("\"auto\""));
    }

    #[test]
    fn isotropic_media_have_no_similar_ones() {
        let scene = |g| {
            let medium = ScatteringInput::Coefficients { sigma_a: Rgb::ONE, sigma_s: Rgb::ONE, g };
            let surface = Surface::Translucent { ior: 1.4, roughness: 0.0, medium };
            Scene { materials: vec![Material { surface, ..Material::default() }], ..Scene::default() }
        };
        assert!(Candidate::SIMILAR_WALK.is_of_its_own_in(&scene(-0.2)));
        assert!(!Candidate::SIMILAR_WALK.is_of_its_own_in(&scene(0.0)));
        assert!(Candidate::WALK.is_of_its_own_in(&scene(0.0)));
    }

    #[test]
    fn each_has_its_own_name_and_colour() {
        for (i, a) in Candidate::ALL.iter().enumerate() {
            assert_eq!(a.index(), i);
            for b in &Candidate::ALL[..i] {
                assert!(a.name() != b.name() && a.style().color != b.style().color);
            }
        }
    }
}
