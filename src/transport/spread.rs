//! The profiles of the colour channels on a body, and the choice between the channels.

use crate::diffusion::{NormalizedDiffusion, Profile, Shape};
use crate::radiometry::Spectrum;

/// The profiles of a material, in one of the two forms that are evaluated at points of a surface: the closed one,
/// and the tabulated one of all others. The choice is made once for each area integral.
#[derive(Clone, Copy, Debug)]
pub enum Spreading<'a, const N: usize = 3> {
    /// Closed form.
    Normalized(Spread<NormalizedDiffusion, N>),
    /// Tabulated form.
    Shaped(Spread<Shape<'a>, N>),
}

/// The profiles of the channels, cut where no point of the body can be.
#[derive(Clone, Copy, Debug)]
pub struct Spread<P, const N: usize = 3> {
    profiles: [P; N],
    /// Energy of each profile within the body's diameter.
    within: [f32; N],
    diameter: f32,
    /// All channels have the same profile.
    gray: bool,
}

/// `length`, the scale of a profile, within 10⁻⁹ and 10⁴ diameters of the body: below, coordinates cannot tell it
/// from 0, and above, the part of the profile that lies on the body no longer changes its form.
pub fn resolvable(length: f32, diameter: f32) -> f32 {
    length.clamp(1e-9 * diameter, 1e4 * diameter)
}

impl<P: Profile + Copy + PartialEq, const N: usize> Spread<P, N> {
    /// `profiles` by channel, of [resolvable] scale, on a body whose points are at most `diameter` (m) apart.
    /// Distances beyond it are never drawn; no energy is lost by that, as nothing is there.
    pub fn new(profiles: [P; N], diameter: f32) -> Self {
        let gray = profiles.iter().all(|profile| *profile == profiles[0]);
        let within = if gray {
            [profiles[0].cumulative(diameter); N]
        } else {
            profiles.map(|p| p.cumulative(diameter))
        };
        Self { profiles, within, diameter, gray }
    }
}

impl<P: Profile + Copy, const N: usize> Spread<P, N> {
    /// The profile of a channel.
    pub(super) fn profile(&self, channel: usize) -> &P {
        &self.profiles[channel]
    }

    /// Energy of each profile within the body's diameter.
    pub(super) fn within(&self) -> [f32; N] {
        self.within
    }

    /// R_c(r)/∫R_c within the diameter, for each channel that carries light.
    pub(super) fn densities(&self, radius: f32, channels: Channels<N>) -> Spectrum<N> {
        if self.gray {
            return Spectrum::splat(self.profiles[0].density(radius) / self.within[0]);
        }
        Spectrum::from_fn(|c| match channels.probability[c] {
            0.0 => 0.0,
            _ => self.profiles[c].density(radius) / self.within[c],
        })
    }

    pub(super) fn sample_radius(&self, channel: usize, xi: f32) -> f32 {
        self.profiles[channel].sample_radius(xi * self.within[channel])
    }

    /// A radius beyond which R̄ stays below `ratio` R̄(`radius`): that beyond which each profile does.
    pub(super) fn reach(&self, radius: f32, ratio: f32) -> f32 {
        let bound = |p: &P| p.radius_of_ratio(radius, ratio);
        let profiles = if self.gray { &self.profiles[..1] } else { &self.profiles[..] };
        profiles.iter().map(bound).fold(0.0, f32::max).min(self.diameter)
    }
}

/// How much of the light each channel carries: the probability with which its profile is drawn from.
///
/// By that choice the light carried in all channels together is the same after the area integral as
/// before, whichever point is drawn, however often a path repeats it; only its colour varies.
#[derive(Clone, Copy, Debug)]
pub struct Channels<const N: usize = 3> {
    probability: Spectrum<N>,
}

impl<const N: usize> Channels<N> {
    /// In proportion to `throughput`; alike if there is none.
    pub fn of(throughput: Spectrum<N>) -> Self {
        let sum: f32 = throughput.0.iter().sum();
        let probability = match sum > 0.0 && sum.is_finite() {
            true => throughput / sum,
            false => Spectrum::splat(1.0 / N as f32),
        };
        Self { probability }
    }

    /// Probability of a channel.
    pub(super) fn probability(&self, channel: usize) -> f32 {
        self.probability[channel]
    }

    /// Mean over the channels by what they carry.
    pub(super) fn mean(&self, values: Spectrum<N>) -> f32 {
        (values * self.probability).0.iter().sum()
    }

    /// Draws a channel in proportion to what it carries times `weights`, whose mean is 1.
    pub(super) fn draw(&self, weights: Spectrum<N>, u: f32) -> usize {
        let shares = self.probability * weights;
        let mut rest = u;
        for c in 0..N {
            rest -= shares[c];
            if rest < 0.0 {
                return c;
            }
        }
        // By rounding only: the largest.
        (0..N).max_by(|&a, &b| shares[a].total_cmp(&shares[b])).unwrap_or(0)
    }
}
