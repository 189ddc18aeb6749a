//! What a scene calls for: which method each translucent body gets, and why.
//!
//! Where the choice is left to the program, the cheapest method is taken whose expected error is within the accuracy asked for:
//! first `diffuse`, then `bssrdf`, then the walk, which has none. The expectation comes from the body's thickness and curvature
//! in free paths ([`body`]) by a table of errors that were measured on simple bodies ([`errors`]).

pub mod body;
pub mod decision;
pub mod effects;
pub mod errors;
mod isotonic;
mod measured;
mod object;
pub mod solid;

pub use decision::Request;
use effects::{Effect, effects};
use measured::Measured;
pub use object::{Expected, PlannedObject};

use crate::scene::{Method, Scene};

/// What is to be done about each translucent body of a scene.
#[derive(Clone, Debug, Default)]
pub struct Plan {
    /// The bodies, in the order of the scene's instances.
    pub objects: Vec<PlannedObject>,
    /// The effects of light there are, and which of them the scene calls for.
    pub effects: Vec<Effect>,
    /// Instances of the scene.
    instances: usize,
}

impl Plan {
    /// Measures the translucent bodies of `scene` and chooses for each as `request` says.
    pub fn new(scene: &Scene, request: &Request) -> Self {
        let mut measured = Measured::default();
        let objects = (0..scene.instances.len())
            .filter_map(|instance| PlannedObject::new(scene, instance, &mut measured, request))
            .collect::<Vec<_>>();
        let effects = effects(scene, &objects);
        Self { objects, effects, instances: scene.instances.len() }
    }

    /// By instance: how light under the surface is computed; `None` where nothing is translucent.
    pub fn methods(&self) -> Vec<Option<Method>> {
        let mut methods = vec![None; self.instances];
        for object in &self.objects {
            methods[object.instance] = Some(object.method);
        }
        methods
    }
}
