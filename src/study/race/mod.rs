//! Ray casters against each other: the rays of a scene, recorded while it was rendered, cast again by each.
//!
//! [`record`] keeps what the path tracer asks, [`replay`] measures how fast it is answered, [`agreement`] whether the answers are the same.

pub mod agreement;
pub mod contest;
pub mod record;
pub mod replay;
pub mod scene;

/// What rays are cast for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Kind {
    /// The nearest hit, from the camera.
    Camera,
    /// The nearest hit, from a surface or a collision.
    Bounce,
    /// Whether a light is hidden.
    Shadow,
    /// Every hit with one instance on a segment, for the area integral.
    Probe,
}

impl Kind {
    /// All kinds, with their names in reports.
    pub const NAMES: [(&'static str, Self); 4] = [
        ("camera", Self::Camera),
        ("bounce", Self::Bounce),
        ("shadow", Self::Shadow),
        ("probe", Self::Probe),
    ];
}
