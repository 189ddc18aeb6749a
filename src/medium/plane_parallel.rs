//! Exact reflectance and transmittance of a flat body with a Henyey–Greenstein phase function behind a
//! smooth dielectric boundary.
//!
//! The body is lit by unit radiance from all sides. By reciprocity, the radiance that it sends back in a
//! direction is then its reflectance for a beam from that direction, so that one solution gives the
//! reflectances of every entry. Radiance inside is given divided by η², which refraction conserves.

use nalgebra::{DMatrix, DVector};

use super::Entry;
use super::discrete_ordinates::{Modes, Ordinates};
use crate::optics::fresnel::Interface;

/// Nodes that resolve phase functions up to |g| = [`BROAD`], and those beyond.
const NODES: [usize; 2] = [48, 80];
const BROAD: f64 = 0.75;

/// A boundary and a phase function: all that does not depend on absorption.
#[derive(Clone, Debug)]
pub struct PlaneParallel {
    eta: f64,
    g: f64,
    ordinates: Ordinates,
    /// The boundary, for light from inside at each node.
    inside: Vec<Interface>,
    /// Share of uniform light on the surface that enters.
    entering: f64,
}

impl PlaneParallel {
    /// For relative index `eta` = n_inside/n_outside > 0 and mean cosine `g` in (−1, 1).
    ///
    /// Results are good to 10⁻⁶ for |g| ≤ 0.75, 10⁻⁵ for |g| ≤ 0.9 and 10⁻⁴ for g = 0.95.
    pub fn new(eta: f64, g: f64) -> Self {
        Self::with_nodes(eta, g, NODES[usize::from(g.abs() > BROAD)])
    }

    /// The same with `count` cosines.
    pub(super) fn with_nodes(eta: f64, g: f64, count: usize) -> Self {
        let critical = ((1.0 - 1.0 / eta) * (1.0 + 1.0 / eta)).max(0.0).sqrt();
        let ordinates = Ordinates::new(critical, count);
        let inside: Vec<_> = ordinates.mu.iter().map(|&mu| Interface::new(mu, 1.0 / eta)).collect();
        let transmitted = (0..ordinates.len())
            .map(|i| ordinates.root_weight[i].powi(2) * ordinates.mu[i] * inside[i].transmittance);
        let entering = 2.0 * eta * eta * transmitted.sum::<f64>();
        Self { eta, g, ordinates, inside, entering }
    }

    /// The half-space in which the share `absorbed_share` = σ_a/σ_t, in [0, 1], of each collision is
    /// absorbed.
    pub fn half_space(&self, absorbed_share: f64) -> HalfSpace<'_> {
        let modes = Modes::new(&self.ordinates, absorbed_share, self.g);
        let field = Field::new(self, &modes, f64::INFINITY, 1.0);
        HalfSpace { layer: self, modes, field, conservative: absorbed_share <= 0.0 }
    }

    /// The slab of optical thickness `optical_thickness` = σ_t × thickness, in the same surroundings
    /// on both sides.
    pub fn slab(&self, absorbed_share: f64, optical_thickness: f64) -> Slab<'_> {
        let modes = Modes::new(&self.ordinates, absorbed_share, self.g);
        let thickness = optical_thickness * modes.optical_scale;
        let symmetric = Field::new(self, &modes, thickness, 1.0);
        let antisymmetric = Field::new(self, &modes, thickness, -1.0);
        Slab { layer: self, modes, symmetric, antisymmetric }
    }
}

/// Radiance in a slab lit by radiance 1 from above and `mirror` (1 or −1) from below.
///
/// In the mode of rate k even degrees vary as cosh and odd ones as sinh of k times the height over
/// the middle, or the reverse, relative to cosh at the surface.
#[derive(Clone, Debug)]
struct Field {
    mirror: f64,
    /// Optical thickness; infinite for a half-space.
    thickness: f64,
    /// How much there is of each mode.
    amplitude: DVector<f64>,
    /// Net flux downward through the upper surface, over the flux that entered there.
    net_flux: f64,
}

impl Field {
    /// Solves I₋ = T + R I₊ at the nodes, for the radiance I₊ up and I₋ down at the upper surface.
    fn new(layer: &PlaneParallel, modes: &Modes, thickness: f64, mirror: f64) -> Self {
        let (ordinates, n) = (&layer.ordinates, layer.ordinates.len());
        let [even, odd] = parities(&modes.rate, thickness, mirror);
        let mut even_part = &ordinates.even * &modes.even;
        let mut odd_part = &ordinates.odd * &modes.odd;
        for j in 0..n {
            even_part.column_mut(j).scale_mut(even[j]);
            odd_part.column_mut(j).scale_mut(odd[j]);
        }
        let matrix = DMatrix::from_fn(n, n, |i, j| {
            let boundary = &layer.inside[i];
            boundary.transmittance * even_part[(i, j)] - (1.0 + boundary.reflectance) * odd_part[(i, j)]
        });
        let incident = DVector::from_fn(n, |i, _| layer.inside[i].transmittance * ordinates.root_weight[i]);
        let amplitude = matrix.lu().solve(&incident).unwrap_or_else(|| DVector::from_element(n, f64::NAN));
        // ∫μ(I₋ − I₊)dμ = −2∫μ ψ₁p₁ dμ.
        let odd_1: f64 = (0..n).map(|j| modes.odd[(0, j)] * odd[j] * amplitude[j]).sum();
        let net_flux = -4.0 * layer.eta * layer.eta * ordinates.beta[1] * odd_1 / layer.entering;
        Self { mirror, thickness, amplitude, net_flux }
    }

    /// Radiance up just below the upper surface at cosine `mu`, where `boundary` reflects and transmits.
    fn upward(&self, modes: &Modes, mu: f64, boundary: &Interface) -> f64 {
        let legendre = orthonormal_legendre(modes.loss.len(), mu);
        let n = modes.rate.len();
        let unscattered = (-self.thickness / mu).exp();
        let scattered: f64 = (0..n)
            .map(|j| {
                let source = |parity: &DMatrix<f64>, odd: usize| -> f64 {
                    (0..n)
                        .map(|i| (1.0 - modes.loss[2 * i + odd]) * legendre[2 * i + odd] * parity[(i, j)])
                        .sum()
                };
                let [even, odd] = depth_integrals(modes.rate[j], mu, self.thickness, self.mirror);
                self.amplitude[j] * (even * source(&modes.even, 0) + odd * source(&modes.odd, 1))
            })
            .sum();
        // From below comes what goes down at the upper surface, T + R I₊, mirrored.
        let from_below = self.mirror * unscattered;
        (scattered + from_below * boundary.transmittance) / (1.0 - from_below * boundary.reflectance)
    }
}

/// What even and odd degrees of each mode amount to at the surface.
fn parities(rate: &[f64], thickness: f64, mirror: f64) -> [Vec<f64>; 2] {
    let cosh = vec![1.0; rate.len()];
    let sinh = rate.iter().map(|k| (0.5 * k * thickness).tanh()).collect();
    if mirror > 0.0 { [cosh, sinh] } else { [sinh, cosh] }
}

/// ∫₀^t v(τ) e^(−τ/μ) dτ/μ for even and odd degrees of a mode, v as in [`Field`].
fn depth_integrals(k: f64, mu: f64, thickness: f64, mirror: f64) -> [f64; 2] {
    // Both are smooth at kμ = 1, where the closed forms are 0/0.
    const NEAR: f64 = 1e-4;
    if (1.0 - k * mu).abs() < NEAR {
        let side = |k| depth_integrals(k, mu, thickness, mirror);
        let ([a, b], [c, d]) = (side((1.0 - 2.0 * NEAR) / mu), side((1.0 + 2.0 * NEAR) / mu));
        return [0.5 * (a + c), 0.5 * (b + d)];
    }
    let e = (-thickness / mu).exp();
    let one_minus_e = -(-thickness / mu).exp_m1();
    let tanh = (0.5 * k * thickness).tanh();
    let denominator = (1.0 - k * mu) * (1.0 + k * mu);
    let cosh = (one_minus_e - k * mu * tanh * (1.0 + e)) / denominator;
    let sinh = (tanh * (1.0 + e) - k * mu * one_minus_e) / denominator;
    if mirror > 0.0 { [cosh, sinh] } else { [sinh, cosh] }
}

/// √(2l+1) P_l(μ) for l < `count`.
fn orthonormal_legendre(count: usize, mu: f64) -> Vec<f64> {
    let (mut previous, mut current) = (0.0, 1.0);
    (0..count)
        .map(|l| {
            let l = l as f64;
            let value = (2.0 * l + 1.0).sqrt() * current;
            (previous, current) = (current, ((2.0 * l + 1.0) * mu * current - l * previous) / (l + 1.0));
            value
        })
        .collect()
}

/// An infinitely thick body: [`PlaneParallel::half_space`].
#[derive(Clone, Debug)]
pub struct HalfSpace<'a> {
    layer: &'a PlaneParallel,
    modes: Modes,
    field: Field,
    /// Nothing is absorbed: all that enters leaves.
    conservative: bool,
}

impl HalfSpace<'_> {
    /// Share of the flux that entered which leaves again.
    pub fn albedo(&self, entry: Entry) -> f64 {
        match entry {
            Entry::Diffuse => 1.0 - self.absorbed(),
            Entry::Normal => self.albedo_at(1.0),
        }
    }

    /// Share of the flux of a beam which entered from cosine `cos_outside` that leaves again.
    pub fn albedo_at(&self, cos_outside: f64) -> f64 {
        if self.conservative {
            return 1.0;
        }
        let refracted = Interface::new(cos_outside, self.layer.eta);
        self.field.upward(&self.modes, refracted.cos_t, &refracted)
    }

    /// Share of the flux on the surface that is reflected, specular reflection included.
    pub fn reflectance(&self, entry: Entry) -> f64 {
        match entry {
            Entry::Diffuse => 1.0 - self.layer.entering * self.absorbed(),
            Entry::Normal => self.reflectance_at(1.0),
        }
    }

    /// Share of the flux of a beam on the surface at cosine `cos_outside` that is reflected, specular
    /// reflection included.
    pub fn reflectance_at(&self, cos_outside: f64) -> f64 {
        let refracted = Interface::new(cos_outside, self.layer.eta);
        1.0 - refracted.transmittance * (1.0 - self.albedo_at(cos_outside))
    }

    /// Share absorbed of the flux that entered from all sides.
    fn absorbed(&self) -> f64 {
        if self.conservative { 0.0 } else { self.field.net_flux }
    }
}

/// A slab in the same surroundings on both sides: [`PlaneParallel::slab`].
///
/// All shares are of the flux on the surface, with specular reflection and unscattered light.
#[derive(Clone, Debug)]
pub struct Slab<'a> {
    layer: &'a PlaneParallel,
    modes: Modes,
    symmetric: Field,
    antisymmetric: Field,
}

impl Slab<'_> {
    /// Shares (reflected, transmitted) of the flux on the upper surface.
    pub fn reflectance_and_transmittance(&self, entry: Entry) -> (f64, f64) {
        match entry {
            Entry::Diffuse => {
                let leaving = |field: &Field| 1.0 - self.layer.entering * field.net_flux;
                let (sum, difference) = (leaving(&self.symmetric), leaving(&self.antisymmetric));
                (0.5 * (sum + difference), 0.5 * (sum - difference))
            }
            Entry::Normal => self.reflectance_and_transmittance_at(1.0),
        }
    }

    /// The same for a beam from cosine `cos_outside`.
    pub fn reflectance_and_transmittance_at(&self, cos_outside: f64) -> (f64, f64) {
        let refracted = Interface::new(cos_outside, self.layer.eta);
        let upward = |field: &Field| field.upward(&self.modes, refracted.cos_t, &refracted);
        let (sum, difference) = (upward(&self.symmetric), upward(&self.antisymmetric));
        let reflected = refracted.reflectance + 0.5 * refracted.transmittance * (sum + difference);
        (reflected, 0.5 * refracted.transmittance * (sum - difference))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The results change by no more than the accuracy stated with many more nodes.
    #[test]
    fn the_quadrature_has_converged() {
        for eta in [0.5, 0.99, 1.0, 1.0001, 1.01, 1.05, 1.33, 1.5, 2.0, 3.0] {
            for (g, accuracy) in [(-0.9, 1e-5), (-0.75, 1e-6), (0.75, 1e-6), (0.9, 1e-5), (0.95, 1e-4)] {
                let [layer, fine] = [PlaneParallel::new(eta, g), PlaneParallel::with_nodes(eta, g, 140)];
                for share in [1e-3, 0.1] {
                    let [ours, exact] = [&layer, &fine].map(|layer| {
                        let half_space = layer.half_space(share);
                        let beam = |mu| half_space.reflectance_at(mu);
                        [half_space.reflectance(Entry::Diffuse), beam(1.0), beam(0.5), beam(0.1)]
                    });
                    for (a, b) in ours.into_iter().zip(exact) {
                        let difference = (a - b).abs();
                        assert!(difference < accuracy, "eta {eta} g {g} share {share}: {difference:e}");
                    }
                }
            }
        }
    }
}
