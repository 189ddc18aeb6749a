//! How light arrives at a flat body.

/// How light arrives at the surface from outside.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Entry {
    /// A pencil beam straight down.
    Normal,
    /// Uniform radiance from all sides (a flux distribution ∝ cosθ), refracted in.
    Diffuse,
}

impl Entry {
    /// The name in outputs.
    pub fn name(self) -> &'static str {
        match self {
            Self::Normal => "normal",
            Self::Diffuse => "diffuse",
        }
    }
}
