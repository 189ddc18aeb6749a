//! From the reflectance wanted to the absorption that gives it, by exact transport.

use std::cmp::Ordering;

use super::plane_parallel::PlaneParallel;
use super::{Entry, Medium};
use crate::radiometry::Rgb;

/// The share absorbed at a collision of the medium reduced by similarity of order 1, σ_a/σ_t', from
/// that of the medium itself, σ_a/σ_t, at mean cosine `g`.
pub fn reduced_share(absorbed_share: f64, g: f64) -> f64 {
    absorbed_share / (absorbed_share + (1.0 - absorbed_share) * (1.0 - g))
}

/// The inverse of [`reduced_share`].
pub fn unreduced_share(reduced_share: f64, g: f64) -> f64 {
    reduced_share * (1.0 - g) / ((1.0 - reduced_share) + reduced_share * (1.0 - g))
}

/// Exact planar albedo of a half-space, and its inverse, for one boundary, phase function and entry.
///
/// "Albedo" is the share of the flux that entered which leaves again. It falls from 1 to 0 as the
/// absorbed share rises from 0 to 1.
#[derive(Clone, Debug)]
pub struct AlbedoInversion {
    layer: PlaneParallel,
    g: f64,
    entry: Entry,
    scale: LossScale,
}

impl AlbedoInversion {
    /// For relative index `eta` = n_inside/n_outside > 0 and mean cosine `g` in (−1, 1).
    pub fn new(eta: f64, g: f64, entry: Entry) -> Self {
        Self::of(PlaneParallel::new(eta, g), g, entry)
    }

    /// On quadrature nodes chosen by the caller.
    pub(super) fn of(layer: PlaneParallel, g: f64, entry: Entry) -> Self {
        let mut inversion = Self { layer, g, entry, scale: LossScale { slope: 1.0 } };
        // There 1 − albedo is its tangent in √x to 10⁻³ of itself or better.
        const NEARLY_WHITE: f64 = 1e-10;
        let loss = 1.0 - inversion.albedo(unreduced_share(NEARLY_WHITE, g));
        inversion.scale.slope = loss / NEARLY_WHITE.sqrt();
        inversion
    }

    /// The variable in which the albedo is nearly linear.
    pub(super) fn scale(&self) -> LossScale {
        self.scale
    }

    /// The albedo where the share `absorbed_share` = σ_a/σ_t of each collision is absorbed.
    pub fn albedo(&self, absorbed_share: f64) -> f64 {
        self.layer.half_space(absorbed_share).albedo(self.entry)
    }

    /// σ_a/σ_t of the medium that has the given albedo (clamped to [0, 1]), in [0, 1]; the albedo is
    /// met to 10⁻⁹ or better.
    pub fn absorbed_share(&self, albedo: f64) -> f64 {
        unreduced_share(self.reduced_share(albedo), self.g)
    }

    /// σ_a/σ_t' of the reduced medium that has the given albedo.
    pub fn reduced_share(&self, albedo: f64) -> f64 {
        let wanted = 1.0 - albedo.clamp(0.0, 1.0);
        let loss = |u| 1.0 - self.albedo(unreduced_share(self.scale.reduced_share(u), self.g));
        self.scale.reduced_share(rising_root(|u| loss(u) - wanted, wanted))
    }

    /// The medium of mean free path `mean_free_path` = 1/σ_t (m) that has `albedo`, for each channel.
    pub fn medium(&self, albedo: Rgb, mean_free_path: Rgb) -> Medium {
        let absorbed = albedo.map(|a| self.absorbed_share(f64::from(a)) as f32);
        let sigma_t = mean_free_path.map(|l| 1.0 / l);
        Medium { sigma_a: absorbed * sigma_t, sigma_s: (Rgb::ONE - absorbed) * sigma_t, g: self.g as f32 }
    }
}

/// A variable u in [0, 1] in which 1 − albedo is nearly u: with s = √(absorbed share) and κ the
/// derivative of 1 − albedo at s = 0, u = κs/(1 + (κ − 1)s).
#[derive(Clone, Copy, Debug)]
pub(super) struct LossScale {
    /// κ.
    slope: f64,
}

impl LossScale {
    /// u at the absorbed share `reduced` of the reduced medium.
    pub fn loss(&self, reduced: f64) -> f64 {
        let s = reduced.sqrt();
        self.slope * s / ((1.0 - s) + self.slope * s)
    }

    /// The absorbed share of the reduced medium at `loss` = u.
    pub fn reduced_share(&self, loss: f64) -> f64 {
        let s = loss / (loss + self.slope * (1.0 - loss));
        s * s
    }
}

/// The zero in [0, 1] of a function that rises from −`guess` to 1 − `guess`, near `guess`: the secant
/// rule within a bracket (the Illinois variant; Dowell and Jarratt 1971).
fn rising_root(f: impl Fn(f64) -> f64, guess: f64) -> f64 {
    const STEPS: usize = 60;
    const ACCURACY: f64 = 1e-12;
    let (mut low, mut high) = ((0.0, -guess), (1.0, 1.0 - guess));
    let mut moved_low = None;
    let mut x = guess;
    for _ in 0..STEPS {
        if x <= low.0 || x >= high.0 {
            break;
        }
        let y = f(x);
        // Also stops at NaN.
        if y.abs().partial_cmp(&ACCURACY) != Some(Ordering::Greater) {
            break;
        }
        // An end that stays twice counts for half, which draws the next secant over the zero.
        let below = y < 0.0;
        if below {
            low = (x, y);
        } else {
            high = (x, y);
        }
        if moved_low == Some(below) {
            let staying = if below { &mut high } else { &mut low };
            staying.1 *= 0.5;
        }
        moved_low = Some(below);
        x = (low.0 * high.1 - high.0 * low.1) / (high.1 - low.1);
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    const ENTRIES: [Entry; 2] = [Entry::Normal, Entry::Diffuse];
    const INDICES: [f64; 4] = [0.75, 1.0, 1.33, 2.0];
    const MEAN_COSINES: [f64; 5] = [-0.5, 0.0, 0.5, 0.8, 0.95];

    fn for_each(test: impl Fn(&AlbedoInversion, &str)) {
        for entry in ENTRIES {
            for eta in INDICES {
                for g in MEAN_COSINES {
                    test(&AlbedoInversion::new(eta, g, entry), &format!("{entry:?} eta {eta} g {g}"));
                }
            }
        }
    }

    #[test]
    fn the_albedo_wanted_is_met_and_the_share_falls_as_it_rises() {
        for_each(|inversion, name| {
            assert_eq!(inversion.absorbed_share(1.0), 0.0, "{name}");
            assert_eq!(inversion.absorbed_share(1.5), 0.0, "{name}");
            assert_eq!(inversion.absorbed_share(0.0), 1.0, "{name}");
            assert_eq!(inversion.absorbed_share(-0.5), 1.0, "{name}");
            let mut above = 1.0;
            for albedo in [1e-9, 1e-4, 0.01, 0.1, 0.3, 0.5, 0.8, 0.95, 0.999, 1.0 - 1e-5, 1.0 - 1e-8] {
                let share = inversion.absorbed_share(albedo);
                assert!(share > 0.0 && share < above, "{name} albedo {albedo}: {share}");
                let found = inversion.albedo(share);
                assert!((found - albedo).abs() < 1e-9, "{name} albedo {albedo}: {found}");
                above = share;
            }
        });
    }

    /// What is lost in a nearly white half-space is proportional to the root of what a collision
    /// absorbs, with a relative error of that root: a hundredth of the loss needs 10⁻⁴ of the absorption.
    #[test]
    fn nearly_white_albedos_keep_their_digits() {
        for_each(|inversion, name| {
            let [grey, white] = [1e-6, 1e-8].map(|loss| inversion.absorbed_share(1.0 - loss));
            // 1 − albedo is met to 1e-12, that is to 1e-4 of the smaller one.
            assert!((white / grey * 1e4 - 1.0).abs() < 3e-4, "{name}: {grey:e} {white:e}");
        });
    }

    #[test]
    fn reduction_is_undone() {
        for g in MEAN_COSINES {
            for share in [0.0, 1e-20, 1e-3, 0.3, 0.999, 1.0] {
                let again = unreduced_share(reduced_share(share, g), g);
                // A handful of roundings, of which 1 − share and 1 − g each count up to 1/(1 − g) times.
                assert!((again - share).abs() <= 200.0 * f64::EPSILON * share, "{g} {share}: {again}");
            }
        }
    }

    #[test]
    fn channels_are_inverted_one_by_one() {
        let inversion = AlbedoInversion::new(1.4, 0.8, Entry::Diffuse);
        let (albedo, mean_free_path) = (Rgb::new(0.9, 0.5, 1.0), Rgb::new(1e-3, 2e-3, 4e-3));
        let medium = inversion.medium(albedo, mean_free_path);
        for c in 0..3 {
            let sigma_t = medium.sigma_a[c] + medium.sigma_s[c];
            assert!((sigma_t * mean_free_path[c] - 1.0).abs() < 4.0 * f32::EPSILON);
            let found = inversion.albedo(f64::from(medium.sigma_a[c] / sigma_t));
            // |d albedo/d ln share| < 1/2, and the share has f32 precision.
            assert!((found - f64::from(albedo[c])).abs() < 4e-7, "channel {c}: {found}");
        }
        assert_eq!(medium.sigma_a[2], 0.0);
    }
}
