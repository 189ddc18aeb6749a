//! Work that casts rays, by whichever caster the command line names.

use super::error::CliError;
use crate::raycast::bvh::BvhCaster;
use crate::raycast::obvhs::ObvhsCaster;
use crate::raycast::{Backend, Geometry, RayCaster, RaycastError};

/// Work for a ray caster of any kind.
pub trait RayWork {
    /// Does the work; `build` makes a caster.
    fn run<C: RayCaster>(self, build: impl Fn(&Geometry) -> Result<C, RaycastError>) -> Result<(), CliError>;
}

/// Does `work` with `backend`.
pub fn run_on(backend: Backend, work: impl RayWork) -> Result<(), CliError> {
    match backend {
        Backend::Embree => run_on_embree(work),
        Backend::Bvh => work.run(BvhCaster::new),
        Backend::Obvhs => work.run(ObvhsCaster::new),
    }
}

#[cfg(feature = "embree")]
fn run_on_embree(work: impl RayWork) -> Result<(), CliError> {
    use crate::raycast::embree::EmbreeCaster;
    let threads = rayon::current_num_threads();
    work.run(|geometry: &Geometry| EmbreeCaster::new(geometry, threads))
}

#[cfg(not(feature = "embree"))]
fn run_on_embree(_work: impl RayWork) -> Result<(), CliError> {
    Err(CliError::input(
        "--backend embree: this program was built without Embree; use --backend bvh, or build it with the \
         feature `embree`",
    ))
}
