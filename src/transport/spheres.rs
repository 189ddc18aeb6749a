//! Steps to the surfaces of spheres in a medium of several channels, by one exit for all of them.
//!
//! The exit is drawn from the law of one channel, taken in proportion to the light that it brings out, L_c W_c with
//! survival W, and weighted by the mean of the three laws in that proportion (one-sample multiple importance sampling
//! by the balance heuristic, Veach 1997, section 9.2.4). With D_c = [`Departure::density`]
//!
//! w_c = D_c Σ_k L_k W_k / Σ_k L_k D_k,
//!
//! so that Σ_c L_c w_c = Σ_c L_c W_c whatever exit is drawn: the light carried by all channels together does not vary.

use std::array;

use super::spread::Channels;
use crate::math::sampler::HashGenerator;
use crate::medium::sphere_step::{Departure, Exit, LARGEST_ABSORBED_SHARE, LEAST_RADIUS};
use crate::medium::{Medium, SphereStep};
use crate::radiometry::Spectrum;

/// The optical radius from which a step costs less than the collisions that it is taken for: three or four.
const PAYS_FROM: f32 = 2.0;

/// What is left of the mean cosine of a direction with the one a walk began with when it is taken for forgotten.
const FORGOTTEN: f32 = 0.01;

/// How far from any surface the similar medium takes the place of a body's own, in its mean free paths.
const LEAST_DEPTH: f32 = 2.0;

/// Steps in a medium that scatters isotropically, for each of the channels it has, or rows of wavelengths.
pub struct SphereTable<const M: usize> {
    /// What the body is filled with.
    body: Medium<M>,
    /// What the steps are in: the same, or the isotropic medium that is similar.
    medium: Medium<M>,
    /// The laws; neighbours that are the same share one.
    steps: Vec<SphereStep>,
    /// By channel, its law; none if it absorbs so much that light does not get far.
    of_channel: [Option<u8>; M],
}

/// Those steps for the channels of a path.
#[derive(Clone, Copy)]
pub struct Spheres<'a, const N: usize = 3> {
    body: Medium<N>,
    medium: Medium<N>,
    sigma_t: Spectrum<N>,
    steps: [&'a SphereStep; N],
    /// All channels are the same.
    gray: bool,
}

/// An isotropic medium that stands for an anisotropic one, where it does so well.
///
/// A flight in it is as long in the mean as the way that light goes on in its direction after a collision in the medium it stands for,
/// so that changing from one to the other and back displaces nothing in the mean.
#[derive(Clone, Copy, Debug)]
pub struct Similarity<const N: usize = 3> {
    /// The medium.
    pub medium: Medium<N>,
    /// Collisions after which the direction at the start of a walk is forgotten.
    pub least_collisions: u32,
    /// The least distance to any surface, m.
    pub least_depth: f32,
}

/// What leaves a sphere, by channel.
pub struct Departures<'a, const N: usize = 3> {
    channels: [Departure<'a>; N],
    gray: bool,
    /// L_c.
    throughput: Spectrum<N>,
    /// L_c W_c.
    surviving: Spectrum<N>,
}

impl<const M: usize> SphereTable<M> {
    /// Prepares the steps in a body; None if its medium does not scatter isotropically.
    ///
    /// Anisotropic media have no such steps: the law of an exit depends on the direction before. With `similarity` they have
    /// those of the isotropic medium that is similar to order 1, an approximation.
    pub fn new(body: Medium<M>, similarity: bool) -> Option<Self> {
        let medium = if similarity { body.similar() } else { body };
        let sigma_t = medium.sigma_t();
        if medium.g != 0.0 || !sigma_t.is_finite() || sigma_t.min_component() <= 0.0 {
            return None;
        }
        let mut table = Self { body, medium, steps: Vec::new(), of_channel: [None; M] };
        let mut last = None;
        for c in 0..M {
            let share = medium.sigma_a[c] / sigma_t[c];
            if last != Some(share) {
                table.steps.extend(SphereStep::new(share));
                last = Some(share);
            }
            let is_known = (0.0..=LARGEST_ABSORBED_SHARE).contains(&share);
            table.of_channel[c] = is_known.then(|| (table.steps.len() - 1) as u8);
        }
        (!table.steps.is_empty()).then_some(table)
    }

    /// For a path that carries `channels`; None if one of them absorbs so much that light does not get far.
    pub fn of<const N: usize>(&self, channels: [usize; N]) -> Option<Spheres<'_, N>> {
        let mut steps = [&self.steps[0]; N];
        for (step, c) in steps.iter_mut().zip(channels) {
            *step = &self.steps[usize::from(self.of_channel[c]?)];
        }
        let (body, medium) = (self.body.channels(channels), self.medium.channels(channels));
        let gray = medium.sigma_a.is_gray() && medium.sigma_s.is_gray();
        Some(Spheres { body, medium, sigma_t: medium.sigma_t(), steps, gray })
    }
}

impl<'a, const N: usize> Spheres<'a, N> {
    /// What the body is filled with.
    pub fn body(&self) -> &Medium<N> {
        &self.body
    }

    /// True if the medium of the steps is only similar to the body's.
    pub fn are_similar(&self) -> bool {
        self.body.g != 0.0
    }

    /// The medium that is similar, where a walk may be taken to be in it; None if the body's own is that of the steps.
    pub fn similarity(&self) -> Option<Similarity<N>> {
        let least_depth = LEAST_DEPTH / self.sigma_t.min_component();
        let least_collisions = (FORGOTTEN.ln() / self.body.g.abs().ln()).ceil() as u32;
        self.are_similar().then_some(Similarity { medium: self.medium, least_collisions, least_depth })
    }

    /// The least radius, m, of a sphere that is worth while for light that is `throughput`: that of the channel that leads, if no
    /// sphere is too small for another one.
    pub fn least_radius(&self, throughput: Spectrum<N>) -> f32 {
        let lead = (1..N).fold(0, |lead, c| if throughput[c] > throughput[lead] { c } else { lead });
        (PAYS_FROM / self.sigma_t[lead]).max(LEAST_RADIUS / self.sigma_t.min_component())
    }

    /// What leaves a sphere of `radius` (m) if `throughput` starts at its centre.
    pub fn departures(&self, radius: f32, throughput: Spectrum<N>) -> Departures<'a, N> {
        let departure = |c: usize| self.steps[c].departure(radius * self.sigma_t[c]);
        let first = departure(0);
        let channels = if self.gray {
            [first; N]
        } else {
            array::from_fn(|c| if c == 0 { first } else { departure(c) })
        };
        let surviving = throughput * Spectrum::from_fn(|c| channels[c].survival());
        Departures { channels, gray: self.gray, throughput, surviving }
    }
}

impl<const N: usize> Departures<'_, N> {
    /// The light that leaves in all channels together.
    fn total(&self) -> f32 {
        self.surviving.0.iter().sum()
    }

    /// Draws an exit.
    pub fn sample(&self, random: &mut HashGenerator) -> Exit {
        let channel =
            if self.gray { 0 } else { Channels::of(self.surviving).draw(Spectrum::ONE, random.next_f32()) };
        self.channels[channel].sample(random.next_f32())
    }

    /// The share of each channel's light that leaves like this, D_c: by angle, where the exit has one.
    pub fn densities(&self, exit: Exit) -> Spectrum<N> {
        if self.gray {
            return Spectrum::splat(self.channels[0].density(exit));
        }
        Spectrum::from_fn(|c| self.channels[c].density(exit))
    }

    /// The density with which [`Departures::sample`] draws an exit that has these `densities`.
    pub fn sampled(&self, densities: Spectrum<N>) -> f32 {
        let total = self.total();
        if total > 0.0 { (self.throughput * densities).0.iter().sum::<f32>() / total } else { 0.0 }
    }

    /// The throughput beyond an exit that was drawn; 0 if there is nothing to bring out.
    pub fn carried(&self, exit: Exit) -> Spectrum<N> {
        if self.gray {
            return self.surviving;
        }
        let leaving = self.throughput * self.densities(exit);
        let sum: f32 = leaving.0.iter().sum();
        if sum > 0.0 { leaving * (self.total() / sum) } else { Spectrum::ZERO }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::radiometry::Rgb;

    fn medium(g: f32) -> Medium {
        Medium { sigma_a: Rgb::new(0.01, 0.4, 10.0), sigma_s: Rgb::new(100.0, 40.0, 250.0), g }
    }

    fn of_all(table: &Option<SphereTable<3>>) -> Option<Spheres<'_>> {
        table.as_ref()?.of([0, 1, 2])
    }

    fn spheres(g: f32) -> Option<SphereTable<3>> {
        SphereTable::new(medium(g), false)
    }

    #[test]
    fn anisotropic_and_dark_media_have_none() {
        assert!(spheres(0.0).is_some());
        assert!(spheres(0.5).is_none());
        let dark = Medium { sigma_a: Rgb::new(0.0, 0.0, 2.0), sigma_s: Rgb::ONE, g: 0.0 };
        let dark = SphereTable::new(dark, false).unwrap();
        assert!(dark.of([0, 1, 2]).is_none());
        assert!(dark.of([1, 0]).is_some());
        assert!(SphereTable::new(Medium::<3>::clear(Rgb::ZERO), true).is_none());
    }

    #[test]
    fn anisotropic_media_have_those_of_a_similar_one_if_wanted() {
        assert!(of_all(&SphereTable::new(medium(0.0), true)).unwrap().similarity().is_none());
        let table = SphereTable::new(medium(-0.5), true);
        let spheres = of_all(&table).unwrap();
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
        let table = spheres(0.0);
        let spheres = of_all(&table).unwrap();
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
        let table = spheres(0.0);
        let spheres = of_all(&table).unwrap();
        let least = |throughput| spheres.least_radius(throughput);
        // One mean free path of the second channel is more than two of the others.
        assert_eq!(least(Rgb::new(0.1, 0.3, 0.2)), 2.0 / 40.4);
        assert_eq!(least(Rgb::new(1.0, 0.0, 0.0)), 1.0 / 40.4);
        assert_eq!(least(Rgb::new(0.1, 0.2, 0.3)), 1.0 / 40.4);
    }
}
