//! Walk on spheres for scattering media: from the centre of a sphere to its surface in one step, by exact transport.
//!
//! Light has just been scattered, isotropically, at the centre of a sphere of one medium that scatters isotropically.
//! It leaves the sphere somewhere for the first time. By symmetry
//!
//! * the place is uniform on the sphere, and the direction uniform in azimuth about the normal there;
//! * the angle between direction and outward normal has a law that depends on the optical radius τ = σ_t R and the
//!   single-scattering albedo ω only, as does the share W of the light that is not absorbed on the way.
//!
//! Beyond the surface it flies on: free flights have no memory, so a fresh one begins there in the direction of the exit.
//! Nothing is approximated but by the resolution of a table: survival is right to 10⁻⁴ of itself where it is above 10⁻³, and
//! the law of the angle to 0.1 % of the light. The table comes from a solution of the equation of transfer by discrete
//! ordinates, in `examples/make_sphere_table`, and is held to random walks by a test.
//!
//! Some of the light, e^(−τ), is never scattered and leaves along the normal. That is an [`Exit`] of its own, with a
//! probability and not a density.
//!
//! **Several wavelengths.** One sphere is an optical radius and an albedo for each. An exit drawn for one of them has the
//! weight [`Departure::density`] of each other wavelength over the density that it was drawn with: densities that count
//! survival, so that they are shares of the light that started. Interpolated tables are distributions
//! themselves and are sampled exactly, so no bias comes of that.
//!
//! **When.** The table costs as much as five collisions, so it pays from an optical radius of 3 on. The distance to the surface costs
//! ten or so, and is asked in vain near the surface, where most light stays for a few collisions and leaves: a walk does
//! well to ask only after 32 collisions since it entered, or since a sphere was last too small. Through an
//! index-matched sphere of 82 k triangles 200 mean free paths thick that takes half the time of a plain walk, through one
//! of 2000 an eighth, through one of 60 the same (`benches/sphere_step.rs`). Where the distance is looked up in a grid, which costs less than a
//! collision, a walk does well to ask at each (`benches/sphere_walk.rs`).
//!
//! **Path length.** Without absorption, r² + 2 r·d along a path in direction d grows in the mean by 2 per mean free path (the
//! second term drops to 0 at each collision). It starts as 0 and is τ² + 2τ cos θ at the exit, so that
//! τ²/2 + τ cos θ has the mean of the optical path length: [`Exit::path_length`].

pub mod table;

use std::f32::consts::LN_2;

use table::{ANGLE_STEP, ANGLES, asymptotic_survival, decay_rate, interpolate};

/// The least optical radius: in smaller spheres there is next to no collision to save.
pub const LEAST_RADIUS: f32 = 1.0;

/// The largest share absorbed at a collision: beyond it light is gone after a step or two.
pub const LARGEST_ABSORBED_SHARE: f32 = 0.5;

/// Nodes in each doubling of the optical radius.
const PER_OCTAVE: usize = 8;

/// From τ = 1 to 16384, beyond which the law of the angle does not change by more than 10⁻⁴.
const NODES: usize = 14 * PER_OCTAVE + 1;

/// Steps to the surfaces of spheres of one medium, at one wavelength.
#[derive(Clone, Debug)]
pub struct SphereStep {
    /// κ: what the field decays by in a mean free path.
    kappa: f32,
    nodes: Vec<Node>,
}

/// What is known at one optical radius.
#[derive(Clone, Debug)]
struct Node {
    /// Survival over its asymptotic form.
    survival: f32,
    /// Density of the exit angle at nodes [`ANGLE_STEP`] apart; straight lines between them.
    density: [f32; ANGLES],
    /// Its integral up to each of the nodes; ends with 1.
    cumulative: [f32; ANGLES],
    /// For each of equal steps of the integral the first node that may be above it: where to begin looking.
    guide: [u8; GUIDES],
}

/// Steps of [`Node::guide`].
const GUIDES: usize = 64;

/// How light leaves a sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Exit {
    /// Along the normal, never scattered.
    Straight,
    /// Scattered, with this angle between its direction and the outward normal, in [0, π/2].
    Oblique {
        /// The angle in radians.
        angle: f32,
    },
}

/// What leaves a sphere of given optical radius.
#[derive(Clone, Copy, Debug)]
pub struct Departure<'a> {
    survival: f32,
    /// Share of the light that leaves without collision.
    straight: f32,
    /// The nodes below and above the radius, with their weights.
    nodes: [(&'a Node, f32); 2],
}

impl SphereStep {
    /// Steps in a medium that absorbs the share `absorbed_share` = σ_a/σ_t = 1 − ω at each collision. None if that is not
    /// in [0, [`LARGEST_ABSORBED_SHARE`]].
    pub fn new(absorbed_share: f32) -> Option<Self> {
        if !(0.0..=LARGEST_ABSORBED_SHARE).contains(&absorbed_share) {
            return None;
        }
        let rate = decay_rate(f64::from(absorbed_share));
        let radius = |i: usize| (i as f64 / PER_OCTAVE as f64).exp2();
        let nodes = (0..NODES).map(|i| Node::new(rate, radius(i))).collect();
        Some(Self { kappa: rate.tanh() as f32, nodes })
    }

    /// What leaves a sphere of the optical radius `radius` = σ_t R, which must not be below [`LEAST_RADIUS`].
    pub fn departure(&self, radius: f32) -> Departure<'_> {
        let place = (radius.ln() * (PER_OCTAVE as f32 / LN_2)).clamp(0.0, (NODES - 1) as f32);
        let below = (place as usize).min(NODES - 2);
        let share = place - below as f32;
        let (lower, upper) = (&self.nodes[below], &self.nodes[below + 1]);
        let ratio = lower.survival * (1.0 - share) + upper.survival * share;
        let straight = (-radius).exp();
        let asymptotic = asymptotic_survival(f64::from(self.kappa), f64::from(radius), 0.0) as f32;
        let survival = (ratio * asymptotic).max(straight).min(1.0);
        Departure { survival, straight, nodes: [(lower, 1.0 - share), (upper, share)] }
    }
}

impl Node {
    fn new(rate: f64, radius: f64) -> Self {
        let [survival, densities @ ..] = interpolate(rate, radius);
        // Rounding of the table and of the interpolation.
        let densities = densities.map(|density| density.max(0.0));
        let mut sums = [0.0; ANGLES];
        for i in 1..ANGLES {
            sums[i] = sums[i - 1] + 0.5 * ANGLE_STEP * (densities[i - 1] + densities[i]);
        }
        let total = sums[ANGLES - 1];
        let cumulative = sums.map(|sum| (sum / total) as f32);
        let guide = |i: usize| cumulative.partition_point(|&sum| sum <= i as f32 / GUIDES as f32) as u8;
        Self {
            // Without absorption all is left, to the last digit.
            survival: if rate == 0.0 { 1.0 } else { survival as f32 },
            density: densities.map(|density| (density / total) as f32),
            guide: std::array::from_fn(guide),
            cumulative,
        }
    }

    /// Density at `angle`, per radian.
    fn density(&self, angle: f32) -> f32 {
        let place = angle * (1.0 / ANGLE_STEP as f32);
        let below = (place as usize).min(ANGLES - 2);
        let share = place - below as f32;
        self.density[below] * (1.0 - share) + self.density[below + 1] * share
    }

    /// The angle below which the share `u` of the light is.
    fn sample(&self, u: f32) -> f32 {
        let mut above = usize::from(self.guide[((u * GUIDES as f32) as usize).min(GUIDES - 1)]).max(1);
        while above < ANGLES - 1 && self.cumulative[above] <= u {
            above += 1;
        }
        let (low, high) = (self.density[above - 1], self.density[above]);
        // Within a step the integral is low·x + (high − low)x²/2, in units of the step; solved without cancellation.
        let rest = (u - self.cumulative[above - 1]) / ANGLE_STEP as f32;
        let root = (low * low + 2.0 * (high - low) * rest).max(0.0).sqrt();
        let x = if rest > 0.0 { (2.0 * rest / (low + root)).min(1.0) } else { 0.0 };
        ((above - 1) as f32 + x) * ANGLE_STEP as f32
    }
}

impl Departure<'_> {
    /// The share W of the light that leaves; 0 if that is too little for the number format.
    pub fn survival(&self) -> f32 {
        self.survival
    }

    /// Draws how the light that leaves does, with `u` in [0, 1). Its density is [`Departure::density`] over
    /// [`Departure::survival`].
    pub fn sample(&self, u: f32) -> Exit {
        // The number serves three times, stretched to the interval that it fell into.
        let straight = if self.survival > 0.0 { self.straight / self.survival } else { 0.0 };
        if u < straight {
            return Exit::Straight;
        }
        let u = (u - straight) / (1.0 - straight);
        let [(lower, share), (upper, other)] = self.nodes;
        let angle = if u < share { lower.sample(u / share) } else { upper.sample((u - share) / other) };
        Exit::Oblique { angle }
    }

    /// The share of the light that started which leaves like this: of [`Exit::Straight`] the share itself, otherwise
    /// per radian of the angle.
    pub fn density(&self, exit: Exit) -> f32 {
        match exit {
            Exit::Straight => self.straight,
            Exit::Oblique { angle } => {
                let law = self.nodes.iter().map(|(node, share)| share * node.density(angle)).sum::<f32>();
                (self.survival - self.straight) * law
            }
        }
    }
}

impl Exit {
    /// Cosine between direction and outward normal.
    pub fn cosine(self) -> f32 {
        match self {
            Self::Straight => 1.0,
            // The cosine of π/2 rounded is below 0 in single precision.
            Self::Oblique { angle } => angle.cos().max(0.0),
        }
    }

    /// A number whose mean over all exits is the mean optical length of the paths, if the medium absorbs nothing.
    pub fn path_length(self, radius: f32) -> f32 {
        radius * (0.5 * radius + self.cosine())
    }
}
