//! The random walk of one photon packet through a stack of layers, in double precision.
//!
//! Free flights are drawn as optical depths, which go on across interfaces (Wang et al. 1995, "MCML").
//! At an interface the packet is reflected or refracted by chance, with Fresnel's probability. At a
//! collision it loses the absorbed share of its weight; what is left plays roulette when it is small.

use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::{Rng, SeedableRng};

use super::layers::LayerStack;
use crate::medium::Entry;
use crate::optics::fresnel::Interface;
use crate::optics::phase::HenyeyGreenstein;

/// How light enters at the top, always at x = y = 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Source {
    /// A pencil beam whose direction makes this cosine with the surface's normal; 1: straight down.
    Pencil {
        /// Cosine outside the top, in (0, 1].
        cosine: f64,
    },
    /// Light from all sides of the upper hemisphere alike (flux per solid angle goes with the cosine).
    Diffuse,
}

impl From<Entry> for Source {
    fn from(entry: Entry) -> Self {
        match entry {
            Entry::Normal => Self::Pencil { cosine: 1.0 },
            Entry::Diffuse => Self::Diffuse,
        }
    }
}

/// When a packet plays roulette.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Roulette {
    /// A packet with less weight than this survives with probability weight/this, and then weighs this. 1 makes the
    /// walk analog: a packet is absorbed whole or not at all.
    pub weight: f64,
    /// After this many collisions, and whenever their number has doubled since, packets are dropped. Without it
    /// a packet in a half-space that absorbs nothing makes infinitely many collisions in the mean.
    pub collisions: u64,
    /// Share of the packets that is kept then; they count the more. Below 1/√2, the mean number of collisions is finite.
    pub kept: f64,
}

impl Default for Roulette {
    fn default() -> Self {
        Self { weight: 0.25, collisions: 1 << 14, kept: 0.5 }
    }
}

/// A photon packet between two events.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Photon {
    /// Position; z grows downwards from the top.
    pub position: [f64; 3],
    /// Unit direction of flight.
    pub direction: [f64; 3],
    /// Share of the photon that is left.
    pub weight: f64,
    /// Index of the layer it is in.
    pub layer: usize,
    /// Collisions so far.
    pub collisions: u64,
    /// Geometric length of its way so far, within the layers.
    pub path_length: f64,
    /// Whether it has been in a layer that absorbs or scatters.
    pub met_medium: bool,
}

impl Photon {
    /// Squared distance from the axis.
    pub fn radius_squared(&self) -> f64 {
        let [x, y, _] = self.position;
        x * x + y * y
    }
}

/// Through which face a packet leaves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Face {
    /// z = 0.
    Top,
    /// The bottom of the last layer.
    Bottom,
}

/// What watches the walk and keeps the scores.
pub trait Observer {
    /// A free flight begins.
    #[inline]
    fn fly(&mut self, _photon: &Photon) {}

    /// A collision, `photon.weight` being the weight before it.
    fn collide(&mut self, photon: &Photon);

    /// The packet leaves; its direction is that outside.
    fn leave(&mut self, photon: &Photon, face: Face);

    /// `weight` is reflected before it enters, in a direction of cosine `cosine` with the normal.
    fn reflect_at_entry(&mut self, weight: f64, cosine: f64);
}

/// A layer made ready.
#[derive(Clone, Copy, Debug)]
struct Medium {
    top: f64,
    bottom: f64,
    ior: f64,
    sigma_t: f64,
    /// Infinite in a clear layer.
    mean_free_path: f64,
    /// Share of the weight that survives a collision.
    albedo: f64,
    phase: HenyeyGreenstein,
}

/// A stack made ready to be walked through.
#[derive(Clone, Debug)]
pub struct Walk {
    media: Vec<Medium>,
    ior_above: f64,
    ior_below: f64,
    source: Source,
    roulette: Roulette,
}

/// A packet with its random numbers.
struct Walker<'a, O> {
    walk: &'a Walk,
    random: &'a mut Xoshiro256PlusPlus,
    observer: &'a mut O,
    photon: Photon,
    next_roulette: u64,
}

/// The random numbers of one stream of `seed`.
pub fn random_stream(seed: u64, stream: u64) -> Xoshiro256PlusPlus {
    // Any odd factor keeps the streams of one seed apart; the generator hashes its seed.
    Xoshiro256PlusPlus::seed_from_u64(seed ^ stream.wrapping_mul(0x9e37_79b9_7f4a_7c15))
}

/// Uniform in [0, 1), on a grid of 2⁻⁵³.
#[inline]
pub(super) fn uniform(random: &mut Xoshiro256PlusPlus) -> f64 {
    (random.next_u64() >> 11) as f64 * (1.0 / (1_u64 << 53) as f64)
}

/// A point in the unit disk without its centre, and its squared distance from it.
#[inline]
pub(super) fn in_unit_disk(random: &mut Xoshiro256PlusPlus) -> (f64, f64, f64) {
    loop {
        let (a, b) = (2.0 * uniform(random) - 1.0, 2.0 * uniform(random) - 1.0);
        let s = a * a + b * b;
        if s < 1.0 && s > 0.0 {
            return (a, b, s);
        }
    }
}

impl Walk {
    /// The walk through `stack` of packets from `source`.
    pub fn new(stack: &LayerStack, source: Source, roulette: Roulette) -> Self {
        let mut top = 0.0;
        let media = stack.layers().iter().map(|layer| {
            let sigma_t = layer.sigma_t();
            let bottom = top + layer.thickness;
            let medium = Medium {
                top,
                bottom,
                ior: layer.ior,
                sigma_t,
                mean_free_path: 1.0 / sigma_t,
                albedo: if sigma_t > 0.0 { layer.sigma_s / sigma_t } else { 1.0 },
                phase: HenyeyGreenstein { g: layer.g },
            };
            top = bottom;
            medium
        });
        Self {
            media: media.collect(),
            ior_above: stack.ior_above(),
            ior_below: stack.ior_below(),
            source,
            roulette,
        }
    }

    /// Walks `photons` packets with the random stream number `stream` of `seed`. What happens is a
    /// function of these three numbers alone.
    pub fn run<O: Observer>(&self, photons: u64, seed: u64, stream: u64, observer: &mut O) {
        self.go_on(photons, &mut random_stream(seed, stream), observer);
    }

    /// Walks `photons` packets more with the random numbers that follow.
    pub fn go_on<O: Observer>(&self, photons: u64, random: &mut Xoshiro256PlusPlus, observer: &mut O) {
        for _ in 0..photons {
            let Some(photon) = self.enter(random, observer) else { continue };
            let next_roulette = self.roulette.collisions;
            Walker { walk: self, random, observer, photon, next_roulette }.run();
        }
    }

    /// The packet just below the top, without what is reflected there; nothing if all is.
    fn enter<O: Observer>(&self, random: &mut Xoshiro256PlusPlus, observer: &mut O) -> Option<Photon> {
        let cosine = match self.source {
            Source::Pencil { cosine } => cosine,
            Source::Diffuse => (1.0 - uniform(random)).sqrt(),
        };
        let first = &self.media[0];
        let relative_ior = first.ior / self.ior_above;
        let interface = Interface::new(cosine, relative_ior);
        if interface.reflectance > 0.0 {
            observer.reflect_at_entry(interface.reflectance, cosine);
        }
        // The whole is symmetric about the axis: the beam may come along x.
        let sine = ((1.0 - cosine) * (1.0 + cosine)).max(0.0).sqrt() / relative_ior;
        (interface.transmittance > 0.0).then_some(Photon {
            position: [0.0; 3],
            direction: [sine, 0.0, interface.cos_t],
            weight: interface.transmittance,
            layer: 0,
            collisions: 0,
            path_length: 0.0,
            met_medium: first.sigma_t > 0.0,
        })
    }
}

impl<O: Observer> Walker<'_, O> {
    fn run(mut self) {
        loop {
            self.observer.fly(&self.photon);
            let Some(medium) = self.fly() else { return };
            self.observer.collide(&self.photon);
            self.photon.collisions += 1;
            self.photon.weight *= medium.albedo;
            if !self.survives() {
                return;
            }
            self.scatter(medium.phase);
        }
    }

    /// Flies to the next collision; nothing if the packet leaves before.
    #[inline]
    fn fly(&mut self) -> Option<Medium> {
        let mut depth = -(1.0 - uniform(self.random)).ln();
        loop {
            let medium = self.walk.media[self.photon.layer];
            let [.., z] = self.photon.position;
            let [.., down] = self.photon.direction;
            let face = if down < 0.0 { medium.top } else { medium.bottom };
            // Infinite where the flight is level (and 0, not NaN, at the face itself).
            let to_face = ((face - z) / down).abs().max(0.0);
            let free = depth * medium.mean_free_path;
            if free < to_face {
                self.advance(free);
                return Some(medium);
            }
            if to_face == f64::INFINITY {
                // Level in a clear layer without end: a set of directions of measure 0.
                return None;
            }
            self.advance(to_face);
            self.photon.position[2] = face;
            depth = (depth - to_face * medium.sigma_t).max(0.0);
            if !self.cross(medium.ior) {
                return None;
            }
        }
    }

    #[inline]
    fn advance(&mut self, distance: f64) {
        for (x, d) in self.photon.position.iter_mut().zip(self.photon.direction) {
            *x += d * distance;
        }
        self.photon.path_length += distance;
    }

    /// Reflects or refracts at the face that the packet has come to; false if it leaves.
    fn cross(&mut self, ior: f64) -> bool {
        let photon = &mut self.photon;
        let [.., down] = photon.direction;
        let last = self.walk.media.len() - 1;
        let (beyond, leaves) = match (down < 0.0, photon.layer) {
            (true, 0) => (self.walk.ior_above, Some(Face::Top)),
            (true, layer) => (self.walk.media[layer - 1].ior, None),
            (false, layer) if layer == last => (self.walk.ior_below, Some(Face::Bottom)),
            (false, layer) => (self.walk.media[layer + 1].ior, None),
        };
        if beyond != ior {
            let relative_ior = beyond / ior;
            let interface = Interface::new(down.abs(), relative_ior);
            if uniform(self.random) < interface.reflectance {
                photon.direction[2] = -down;
                return true;
            }
            photon.direction[0] /= relative_ior;
            photon.direction[1] /= relative_ior;
            photon.direction[2] = interface.cos_t.copysign(down);
        }
        if let Some(face) = leaves {
            self.observer.leave(photon, face);
            return false;
        }
        photon.layer = if down < 0.0 { photon.layer - 1 } else { photon.layer + 1 };
        photon.met_medium |= self.walk.media[photon.layer].sigma_t > 0.0;
        true
    }

    /// Plays both roulettes.
    #[inline]
    fn survives(&mut self) -> bool {
        let Roulette { weight, kept, .. } = self.walk.roulette;
        let photon = &mut self.photon;
        if photon.weight < weight || photon.weight == 0.0 {
            if uniform(self.random) * weight >= photon.weight {
                return false;
            }
            photon.weight = weight;
        }
        if photon.collisions >= self.next_roulette {
            self.next_roulette = self.next_roulette.saturating_mul(2);
            if uniform(self.random) >= kept {
                return false;
            }
            photon.weight /= kept;
        }
        true
    }

    #[inline]
    fn scatter(&mut self, phase: HenyeyGreenstein) {
        self.photon.direction = scattered(self.photon.direction, phase, self.random);
    }
}

/// `direction`, turned by a deflection drawn from the phase function.
#[inline]
pub(super) fn scattered(
    direction: [f64; 3],
    phase: HenyeyGreenstein,
    random: &mut Xoshiro256PlusPlus,
) -> [f64; 3] {
    let (a, b, s) = in_unit_disk(random);
    if phase.g == 0.0 {
        // Marsaglia 1972: from the disk onto the sphere, without a trigonometric function.
        let scale = 2.0 * (1.0 - s).sqrt();
        return [a * scale, b * scale, 1.0 - 2.0 * s];
    }
    let deflection = phase.sample(uniform(random));
    // Azimuth from the disk: (a, b)/√s is uniform on the circle.
    let across = deflection.sin / s.sqrt();
    let [x, y, z] = direction;
    // Orthonormal basis about the direction (Duff et al. 2017).
    let sign = 1.0_f64.copysign(z);
    let c = -1.0 / (sign + z);
    let d = x * y * c;
    let (p, q) = (a * across, b * across);
    [
        p * (1.0 + sign * x * x * c) + q * d + x * deflection.cos,
        p * sign * d + q * (sign + y * y * c) + y * deflection.cos,
        -p * sign * x - q * y + z * deflection.cos,
    ]
}
