//! Steps to the surfaces of spheres in a medium of three channels, by one exit for all of them.
//!
//! The exit is drawn from the law of one channel, taken in proportion to the light that it brings out, L_c W_c with
//! survival W, and weighted by the mean of the three laws in that proportion (one-sample multiple importance sampling
//! by the balance heuristic, Veach 1997, section 9.2.4). With D_c = [`Departure::density`]
//!
//! w_c = D_c Σ_k L_k W_k / Σ_k L_k D_k,
//!
//! so that Σ_c L_c w_c = Σ_c L_c W_c whatever exit is drawn: the light carried by all channels together does not vary.

use super::spread::Channels;
use crate::math::sampler::HashGenerator;
use crate::medium::sphere_step::{Departure, Exit, LEAST_RADIUS};
use crate::medium::{Medium, SphereStep};
use crate::radiometry::Rgb;

/// The optical radius from which a step costs less than the collisions that it is taken for: three or four.
const PAYS_FROM: f32 = 2.0;

/// What is left of the mean cosine of a direction with the one a walk began with when it is taken for forgotten.
const FORGOTTEN: f32 = 0.01;

/// How far from any surface the similar medium takes the place of a body's own, in its mean free paths.
const LEAST_DEPTH: f32 = 2.0;

/// Steps in a medium that scatters isotropically.
pub struct Spheres {
    /// What the body is filled with.
    body: Medium,
    /// What the steps are in: the same, or the isotropic medium that is similar.
    medium: Medium,
    sigma_t: Rgb,
    steps: [SphereStep; 3],
    /// All channels are the same.
    gray: bool,
}

/// An isotropic medium that stands for an anisotropic one, where it does so well.
///
/// A flight in it is as long in the mean as the way that light goes on in its direction after a collision in the medium it stands for,
/// so that changing from one to the other and back displaces nothing in the mean.
#[derive(Clone, Copy, Debug)]
pub struct Similarity {
    /// The medium.
    pub medium: Medium,
    /// Collisions after which the direction at the start of a walk is forgotten.
    pub least_collisions: u32,
    /// The least distance to any surface, m.
    pub least_depth: f32,
}

/// What leaves a sphere, by channel.
pub struct Departures<'a> {
    channels: [Departure<'a>; 3],
    gray: bool,
    /// L_c.
    throughput: Rgb,
    /// L_c W_c.
    surviving: Rgb,
}

impl Spheres {
    /// Prepares the steps in a body; None if its medium does not scatter isotropically, or a channel absorbs so much that light does not
    /// get far.
    ///
    /// Anisotropic media have no such steps: the law of an exit depends on the direction before. With `similarity` they have
    /// those of the isotropic medium that is similar to order 1, an approximation.
    pub fn new(body: Medium, similarity: bool) -> Option<Self> {
        let medium = if similarity { body.similar() } else { body };
        let sigma_t = medium.sigma_t();
        if medium.g != 0.0 || !sigma_t.is_finite() || sigma_t.min_component() <= 0.0 {
            return None;
        }
        let shares = medium.sigma_a.zip(sigma_t, |a, t| a / t);
        let steps = [SphereStep::new(shares[0])?, SphereStep::new(shares[1])?, SphereStep::new(shares[2])?];
        let is_same = |values: Rgb| values[0] == values[1] && values[0] == values[2];
        Some(Self { body, medium, sigma_t, steps, gray: is_same(sigma_t) && is_same(shares) })
    }

    /// What the body is filled with.
    pub fn body(&self) -> &Medium {
        &self.body
    }

    /// True if the medium of the steps is only similar to the body's.
    pub fn are_similar(&self) -> bool {
        self.body.g != 0.0
    }

    /// The medium that is similar, where a walk may be taken to be in it; None if the body's own is that of the steps.
    pub fn similarity(&self) -> Option<Similarity> {
        let least_depth = LEAST_DEPTH / self.sigma_t.min_component();
        let least_collisions = (FORGOTTEN.ln() / self.body.g.abs().ln()).ceil() as u32;
        self.are_similar().then_some(Similarity { medium: self.medium, least_collisions, least_depth })
    }

    /// The least radius, m, of a sphere that is worth while for light that is `throughput`: that of the channel that leads, if no
    /// sphere is too small for another one.
    pub fn least_radius(&self, throughput: Rgb) -> f32 {
        let [r, g, b] = throughput.0;
        let lead = if r >= g && r >= b {
            0
        } else if g >= b {
            1
        } else {
            2
        };
        (PAYS_FROM / self.sigma_t[lead]).max(LEAST_RADIUS / self.sigma_t.min_component())
    }

    /// What leaves a sphere of `radius` (m) if `throughput` starts at its centre.
    pub fn departures(&self, radius: f32, throughput: Rgb) -> Departures<'_> {
        let departure = |c: usize| self.steps[c].departure(radius * self.sigma_t[c]);
        let first = departure(0);
        let channels = if self.gray { [first; 3] } else { [first, departure(1), departure(2)] };
        let surviving = throughput * Rgb::from_fn(|c| channels[c].survival());
        Departures { channels, gray: self.gray, throughput, surviving }
    }
}

impl Departures<'_> {
    /// The light that leaves in all channels together.
    fn total(&self) -> f32 {
        self.surviving.0.iter().sum()
    }

    /// Draws an exit.
    pub fn sample(&self, random: &mut HashGenerator) -> Exit {
        let channel =
            if self.gray { 0 } else { Channels::of(self.surviving).draw(Rgb::ONE, random.next_f32()) };
        self.channels[channel].sample(random.next_f32())
    }

    /// The share of each channel's light that leaves like this, D_c: by angle, where the exit has one.
    pub fn densities(&self, exit: Exit) -> Rgb {
        if self.gray {
            return Rgb::splat(self.channels[0].density(exit));
        }
        Rgb::from_fn(|c| self.channels[c].density(exit))
    }

    /// The density with which [`Departures::sample`] draws an exit that has these `densities`.
    pub fn sampled(&self, densities: Rgb) -> f32 {
        let total = self.total();
        if total > 0.0 { (self.throughput * densities).0.iter().sum::<f32>() / total } else { 0.0 }
    }

    /// The throughput beyond an exit that was drawn; 0 if there is nothing to bring out.
    pub fn carried(&self, exit: Exit) -> Rgb {
        if self.gray {
            return self.surviving;
        }
        let leaving = self.throughput * self.densities(exit);
        let sum: f32 = leaving.0.iter().sum();
        if sum > 0.0 { leaving * (self.total() / sum) } else { Rgb::ZERO }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn medium(g: f32) -> Medium {
        Medium { sigma_a: Rgb::new(0.01, 0.4, 10.0), sigma_s: Rgb::new(100.0, 40.0, 250.0), g }
    }

    fn spheres(g: f32) -> Option<Spheres> {
        Spheres::new(medium(g), false)
    }

    #[test]
    fn anisotropic_and_dark_media_have_none() {
        assert!(spheres(0.0).is_some());
        assert!(spheres(0.5).is_none());
        let dark = Medium { sigma_a: Rgb::new(0.0, 0.0, 2.0), sigma_s: Rgb::ONE, g: 0.0 };
        assert!(Spheres::new(dark, false).is_none());
        assert!(Spheres::new(Medium::clear(Rgb::ZERO), true).is_none());
    }

    #[test]
    fn anisotropic_media_have_those_of_a_similar_one_if_wanted() {
        assert!(Spheres::new(medium(0.0), true).unwrap().similarity().is_none());
        let spheres = Spheres::new(medium(-0.5), true).unwrap();
        let similarity = spheres.similarity().unwrap();
        assert_eq!(*spheres.body(), medium(-0.5));
        assert_eq!(similarity.medium.sigma_s, Rgb::new(150.0, 60.0, 375.0));
        assert_eq!((similarity.medium.sigma_a, similarity.medium.g), (medium(0.0).sigma_a, 0.0));
        // 1/64 is not below a hundredth, 1/128 is.
        assert_eq!(similarity.least_collisions, 7);
        assert_eq!(similarity.least_depth, 2.0 / 60.4);
    }

    /// Σ_c L_c w_c is Σ_c L_c W_c for every exit, and each channel's own W in the mean.
    #[test]
    fn light_leaves_as_much_as_survives() {
        const DRAWS: u32 = 200_000;
        let spheres = spheres(0.0).unwrap();
        let throughput = Rgb::new(0.5, 0.2, 0.9);
        let mut random = HashGenerator::new(3);
        for radius in [0.03, 0.1] {
            let departures = spheres.departures(radius, throughput);
            let (mut sum, mut squares) = ([0.0_f64; 3], [0.0_f64; 3]);
            for _ in 0..DRAWS {
                let carried = departures.carried(departures.sample(&mut random));
                let total: f32 = carried.0.iter().sum();
                // A dozen roundings.
                assert!((total - departures.total()).abs() < 1e-6 * departures.total());
                for (c, x) in carried.0.into_iter().enumerate() {
                    sum[c] += f64::from(x);
                    squares[c] += f64::from(x).powi(2);
                }
            }
            for c in 0..3 {
                let count = f64::from(DRAWS);
                let mean = sum[c] / count;
                let sigma = ((squares[c] / count - mean * mean).max(0.0) / count).sqrt();
                let exact = f64::from(departures.surviving[c]);
                assert!((mean - exact).abs() < 3.0 * sigma + 1e-6 * exact, "{mean} ± {sigma}, not {exact}");
            }
        }
    }

    #[test]
    fn the_least_sphere_is_that_of_the_channel_that_leads() {
        let spheres = spheres(0.0).unwrap();
        let least = |throughput| spheres.least_radius(throughput);
        // One mean free path of the second channel is more than two of the others.
        assert_eq!(least(Rgb::new(0.1, 0.3, 0.2)), 2.0 / 40.4);
        assert_eq!(least(Rgb::new(1.0, 0.0, 0.0)), 1.0 / 40.4);
        assert_eq!(least(Rgb::new(0.1, 0.2, 0.3)), 1.0 / 40.4);
    }
}
