//! What a scene calls for: which method each translucent body gets, and why.
//!
//! Where the choice is left to the program, the cheapest method is taken whose expected error is within the accuracy asked for:
//! first `diffuse`, then `bssrdf`, then the walk, which has none. The expectation comes from the body's thickness and curvature
//! in free paths ([`body`]) by a table of errors that were measured on simple bodies ([`errors`]).
//!
//! Of all effects of light ([`effects`]) those are on that the placed surfaces, the lights and the camera call for, once constants are folded
//! ([`fold`]); the user may overrule that ([`force`]). The smallest [`Kernel`] that has code for what is on renders the scene.

pub mod body;
pub mod decision;
mod effect_kind;
pub mod effects;
pub mod errors;
pub mod fold;
pub mod force;
mod isotonic;
mod kernel;
mod measured;
mod needs;
mod object;
pub mod solid;
mod spectral;
pub mod without;

pub use decision::Request;
pub use effect_kind::EffectKind;
use effects::{Effect, effects};
use fold::fold;
pub use force::{ForceError, Forces};
pub use kernel::{Abilities, Kernel};
use measured::Measured;
use needs::needed;
pub use object::{Expected, PlannedObject};

use crate::scene::{Method, Scene};

/// What is to be done about each translucent body of a scene.
#[derive(Clone, Debug, Default)]
pub struct Plan {
    /// The bodies, in the order of the scene's instances.
    pub objects: Vec<PlannedObject>,
    /// The effects of light there are, and which of them the scene calls for.
    pub effects: Vec<Effect>,
    /// What a kernel has to have code for.
    pub needed: Abilities,
    /// The smallest kernel that does.
    pub kernel: Kernel,
    /// Instances of the scene.
    instances: usize,
}

impl Plan {
    /// Reduces `scene` to what its picture depends on, effects that are switched off left out, and plans it.
    ///
    /// # Errors
    /// An effect is switched on that the scene cannot have, or off that it cannot do without.
    pub fn prepare(scene: &mut Scene, request: &Request) -> Result<Self, ForceError> {
        fold(scene);
        request.forces.apply(scene)?;
        fold(scene);
        Ok(Self::new(scene, request))
    }

    /// Measures the translucent bodies of `scene` and chooses for each as `request` says.
    pub fn new(scene: &Scene, request: &Request) -> Self {
        let mut measured = Measured::default();
        let objects = (0..scene.instances.len())
            .filter_map(|instance| PlannedObject::new(scene, instance, &mut measured, request))
            .collect::<Vec<_>>();
        let effects = effects(scene, &objects, &request.forces);
        let mut plan = Self { objects, effects, instances: scene.instances.len(), ..Self::default() };
        plan.needed = needed(scene, &plan.methods()).and(request.forces.abilities());
        if plan.has(EffectKind::Spectral) {
            plan.needed = plan.needed.and(Abilities::SPECTRAL);
        }
        plan.kernel = Kernel::smallest(plan.needed).unwrap_or_default();
        plan
    }

    /// True if the effect is on.
    pub fn has(&self, kind: EffectKind) -> bool {
        self.effects.iter().any(|effect| effect.kind == kind && effect.on)
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
