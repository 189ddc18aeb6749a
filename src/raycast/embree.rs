//! Stand-in for the Embree backend, to be replaced at the merge.

use super::{Hit, Ray, RayCaster};

/// Hits nothing.
pub struct EmbreeCaster;

impl RayCaster for EmbreeCaster {
    fn closest(&self, _ray: &Ray) -> Option<Hit> {
        None
    }

    fn occluded(&self, _ray: &Ray) -> bool {
        false
    }

    fn all_hits(&self, _ray: &Ray, _instance: u32, hits: &mut Vec<Hit>) {
        hits.clear();
    }
}
