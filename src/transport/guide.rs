//! Guides of walks in bodies that absorb: the zero-variance densities of [`crate::medium::dwivedi`] channel by channel, towards a
//! plane where light leaves and towards one on the other side.
//!
//! **Lobes.** In a layer of thickness D light is brought out of depth z in proportion to e^(−κz) by one side and
//! e^(−κ(D − z)) by the other, κ the rate of decay of a channel. In this proportion a guide draws towards either side, by
//! a channel in proportion to the light it carries; in the remaining share, a quarter, it draws like the classic walk. Direction and distance
//! of a flight are drawn by the same lobe.
//!
//! Nothing here has to be right for a walk to be: guides say only how likely they draw what they draw.
//!
//! **Where walks are guided.** A guide costs time at each collision. It pays where light is lost for having gone astray:
//!
//! - where it is absorbed before it would find its way out by itself: up to an albedo of 0.99 in the darkest channel;
//! - where scattering is isotropic, as in the half-space that the densities are of: what other phase functions differ from them by piles up,
//!   collision by collision;
//! - where it can go astray: in bodies whose box is nowhere less than three free paths wide, as out of less it comes any way;
//! - where the body brings out more than its boundary mirrors, which it does both ways: below, most noise is that of the choice between
//!   what is mirrored and what is not.
//!
//! Elsewhere the walk is the classic one.

use std::array;

use glam::Vec3;

use super::spread::Channels;
use crate::math::sampler::HashGenerator;
use crate::medium::dwivedi::Mode;
use crate::medium::{Medium, PlanarAlbedo};
use crate::radiometry::Spectrum;

/// Share of a guide's flights that are drawn like the classic walk's.
const PLAIN: f32 = 0.25;

/// The largest albedo of a channel that is guided.
const MOST_ALBEDO: f32 = 0.99;

/// The least width of a body whose walks are guided, in free paths.
const LEAST_WIDTH: f32 = 3.0;

/// The least that walks can be expected to bring out.
const LEAST_EXPECTED: f32 = 1.0 / 64.0;

/// The largest exponent of a stretch, so that none overflows; what exceeds it weighs nothing.
const MOST_STRETCHED: f32 = 80.0;

/// A guide of walks in a medium.
#[derive(Clone, Copy, Debug)]
pub struct Guide<const N: usize = 3> {
    sigma_t: Spectrum<N>,
    /// By channel; none where so little is absorbed that the classic walk is as good.
    modes: [Option<Mode>; N],
    /// κ, 1/m.
    decay: Spectrum<N>,
    /// All channels are the same.
    gray: bool,
    /// What light that has entered is expected to bring out, in the channel that brings out most.
    expected: f32,
}

/// How a flight is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lobe {
    /// Like the classic walk's.
    Plain,
    /// By a channel, towards the plane where the walk began.
    Outwards(usize),
    /// By a channel, away from there.
    Inwards(usize),
}

/// A guide in a body: towards the plane where a walk began.
#[derive(Clone, Copy, Debug)]
pub struct Layer<const N: usize = 3> {
    guide: Guide<N>,
    normal: Vec3,
    /// Of the plane, along the normal, m.
    height: f32,
    /// m.
    thickness: f32,
}

/// A direction that light takes, and how likely guides draw it.
#[derive(Clone, Copy, Debug)]
pub struct Heading<const N: usize = 3> {
    /// Cosine to the plane's normal.
    cosine: f32,
    /// Densities of the lobes times their shares, relative to the classic walk's density.
    outwards: Spectrum<N>,
    inwards: Spectrum<N>,
    channels: Channels<N>,
}

impl<const N: usize> Guide<N> {
    /// Of a medium in a half-space whose albedo is `planar` and whose boundary reflects `mirrored` at normal incidence; none where the
    /// classic walk is as good.
    pub fn new(medium: &Medium<N>, planar: &PlanarAlbedo, mirrored: f32) -> Option<Self> {
        let absorbed = medium.absorbed_share_reduced();
        let sigma_t = medium.sigma_t();
        let is_absorbing = |c: usize| absorbed[c] >= 1.0 - MOST_ALBEDO;
        let pays = (0..N).any(is_absorbing) && medium.g == 0.0;
        if !pays || !sigma_t.is_finite() || sigma_t.min_component() <= 0.0 {
            return None;
        }
        let expected = absorbed.map(|share| planar.albedo(share)).max_component();
        if expected < 2.0 * mirrored {
            return None;
        }
        let mode = |c: usize| is_absorbing(c).then(|| Mode::new(1.0 - f64::from(absorbed[c])));
        let modes = array::from_fn(mode);
        Some(Self {
            sigma_t,
            modes,
            decay: Spectrum::from_fn(|c| modes[c].map_or(0.0, |mode| mode.decay() * sigma_t[c])),
            gray: sigma_t.is_gray() && absorbed.is_gray(),
            expected: expected.clamp(LEAST_EXPECTED, 1.0),
        })
    }

    /// True if walks are worth guiding in a body `width` m wide where it is narrowest.
    pub fn pays_in(&self, width: f32) -> bool {
        width * self.sigma_t.min_component() >= LEAST_WIDTH
    }

    /// Share of the light entered that is expected to leave again.
    pub fn expected(&self) -> f32 {
        self.expected
    }

    /// Channels that differ.
    fn count(&self) -> usize {
        if self.gray { 1 } else { N }
    }
}

impl<const N: usize> Layer<N> {
    /// Below the plane through `origin` with outward unit `normal`; `thickness` in m.
    pub fn new(guide: Guide<N>, origin: Vec3, normal: Vec3, thickness: f32) -> Self {
        Self { guide, normal, height: normal.dot(origin), thickness }
    }

    /// Share of the light of channel `c` that the other side brings out of `point`.
    fn inward_share(&self, c: usize, point: Vec3) -> f32 {
        let depth = self.height - self.normal.dot(point);
        1.0 / (1.0 + (self.guide.decay[c] * (self.thickness - 2.0 * depth)).exp())
    }

    /// Probability of channel `c`, of those that differ.
    fn share(&self, c: usize, channels: &Channels<N>) -> f32 {
        if self.guide.gray { 1.0 } else { channels.probability(c) }
    }

    /// Draws by which lobe to go on from `point`.
    pub fn draw_lobe(&self, point: Vec3, channels: &Channels<N>, random: &mut HashGenerator) -> Lobe {
        if random.next_f32() < PLAIN {
            return Lobe::Plain;
        }
        let c = if self.guide.gray { 0 } else { channels.draw(Spectrum::ONE, random.next_f32()) };
        if random.next_f32() < self.inward_share(c, point) { Lobe::Inwards(c) } else { Lobe::Outwards(c) }
    }

    /// Going on from `point` in a given direction.
    pub fn straight(&self, point: Vec3, direction: Vec3, channels: Channels<N>) -> Heading<N> {
        self.heading(point, direction, channels, |_, _| 1.0)
    }

    /// Going on from `point` in a direction that the phase function draws with density `phase`, 1/sr.
    pub fn turned(&self, point: Vec3, direction: Vec3, phase: f32, channels: Channels<N>) -> Heading<N> {
        let cosine = direction.dot(self.normal);
        self.heading(point, direction, channels, |mode, side| mode.density(side * cosine) / phase)
    }

    fn heading(
        &self,
        point: Vec3,
        direction: Vec3,
        channels: Channels<N>,
        relative: impl Fn(&Mode, f32) -> f32,
    ) -> Heading<N> {
        let (mut outwards, mut inwards) = (Spectrum::ZERO, Spectrum::ZERO);
        for c in 0..self.guide.count() {
            let share = (1.0 - PLAIN) * self.share(c, &channels);
            let inward = self.inward_share(c, point);
            let density = |side| self.guide.modes[c].as_ref().map_or(1.0, |mode| relative(mode, side));
            outwards.0[c] = share * (1.0 - inward) * density(1.0);
            inwards.0[c] = share * inward * density(-1.0);
        }
        Heading { cosine: direction.dot(self.normal), outwards, inwards, channels }
    }

    /// Draws the cosine of a direction to the plane's normal; none if the phase function draws it.
    pub fn draw_cosine(&self, lobe: Lobe, random: &mut HashGenerator) -> Option<f32> {
        let (c, side) = lobe.side()?;
        Some(side * self.guide.modes[c].as_ref()?.sample(random.next_f32()))
    }

    /// The plane's outward normal.
    pub fn normal(&self) -> Vec3 {
        self.normal
    }

    /// The coefficient, 1/m, by which `lobe` draws flights, and its channel; none if the classic walk's are drawn.
    pub fn coefficient(&self, lobe: Lobe, heading: &Heading<N>) -> Option<(usize, f32)> {
        lobe.side().map(|(c, side)| (c, self.stretched(c, side * heading.cosine)))
    }

    /// σ_t (1 − µ/ν0) of channel `c`, 1/m.
    fn stretched(&self, c: usize, cosine: f32) -> f32 {
        self.guide.sigma_t[c] - self.guide.decay[c] * cosine
    }

    /// How much likelier guides draw a collision after `distance` than the classic walk, given `attenuation` over it in any unit.
    pub fn collision_ratio(&self, heading: &Heading<N>, distance: f32, attenuation: Spectrum<N>) -> f32 {
        self.ratio(heading, distance, attenuation, |c, cosine| self.stretched(c, cosine))
    }

    /// How much likelier guides draw a flight that goes on at least to `distance`.
    pub fn passage_ratio(&self, heading: &Heading<N>, distance: f32, attenuation: Spectrum<N>) -> f32 {
        self.ratio(heading, distance, attenuation, |_, _| 1.0)
    }

    /// `factor` is what the exponential e^(−σ t) of a channel is multiplied by, for a flight of given cosine; a classic one is that of cosine
    /// 0.
    fn ratio(
        &self,
        heading: &Heading<N>,
        distance: f32,
        attenuation: Spectrum<N>,
        factor: impl Fn(usize, f32) -> f32,
    ) -> f32 {
        let (mut guided, mut classic) = (0.0, 0.0);
        for c in 0..self.guide.count() {
            let exponent = self.guide.decay[c] * heading.cosine * distance;
            let stretch = exponent.clamp(-MOST_STRETCHED, MOST_STRETCHED).exp();
            let outwards = heading.outwards[c] * factor(c, heading.cosine) * stretch;
            let inwards = heading.inwards[c] * factor(c, -heading.cosine) / stretch;
            guided += attenuation[c] * (outwards + inwards);
            classic += attenuation[c] * self.share(c, &heading.channels) * factor(c, 0.0);
        }
        PLAIN + guided / classic
    }
}

impl Lobe {
    /// Its channel, and the sign of cosines to the normal of the plane it looks for; none if it looks for neither.
    fn side(self) -> Option<(usize, f32)> {
        match self {
            Self::Plain => None,
            Self::Outwards(c) => Some((c, 1.0)),
            Self::Inwards(c) => Some((c, -1.0)),
        }
    }
}

impl<const N: usize> Heading<N> {
    /// How much likelier guides draw the direction than the classic walk.
    pub fn ratio(&self) -> f32 {
        PLAIN + (self.outwards + self.inwards).0.iter().sum::<f32>()
    }
}
