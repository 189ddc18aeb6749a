//! The equation of transfer in a sphere with a point source at its centre, by discrete ordinates.
//!
//! Unit: the mean free path. For isotropic scattering, r times the fluence φ(r) obeys the equation of a slab [0, R] with
//! an odd continuation (Case and Zweifel 1967, "Linear Transport Theory", section 6.7):
//!
//! ψ(r) = rφ(r) = q(r) + (ω/2) ∫_0^R ψ(r') [E1(|r − r'|) − E1(r + r')] dr',   q(r) = e^(−r)/(4πr).
//!
//! In directions of cosine m, ψ is the fluence of a field f with m df/dr + f = (ω/2)ψ, whose boundary conditions are
//! f(R, −m) = 0 and f(0, m) + f(0, −m) = 1/(4πm²), as q(r) = ∫_0^1 e^(−r/m)/(4πm²) dm. On the nodes of a quadrature
//! the solution is a sum of exponentials.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use alabaster::math::quadrature::GaussLegendre;
use nalgebra::{DMatrix, DVector};

/// Nodes on (0, 1), crowded towards 0, where the point source is.
const ORDINATES: usize = 40;

/// Beyond this optical depth nothing is seen from the surface.
const OPAQUE: f64 = 45.0;

/// Cosines and weights.
fn ordinates() -> Vec<(f64, f64)> {
    let rule = GaussLegendre::new(ORDINATES);
    rule.nodes().iter().map(|&(x, w)| (x * x, 2.0 * x * w)).collect()
}

/// The field in one sphere, times e^(κR), so that it has digits however much the medium absorbs.
pub struct Sphere {
    ordinates: Vec<(f64, f64)>,
    radius: f64,
    albedo: f64,
    /// Rates of the modes; the first is κ.
    rates: Vec<f64>,
    /// Coefficients of e^(−kr) times e^(κR).
    outward: Vec<f64>,
    /// Coefficients of e^(−k(R−r)); of the first mode, of sinh(κr)/κ · e^(−κR).
    inward: Vec<f64>,
}

/// The single-scattering albedo ω at which light decays at the rate `kappa`: 1 = ω ∫_0^1 dm/(1 − κ²m²).
fn albedo(ordinates: &[(f64, f64)], kappa: f64) -> f64 {
    1.0 / ordinates.iter().map(|&(m, w)| w / (1.0 - (kappa * m).powi(2))).sum::<f64>()
}

/// The rates of decay: the roots k of 1 = ω Σ w/(1 − k²m²). Between two neighbouring poles 1/m there is one.
fn rates(ordinates: &[(f64, f64)], kappa: f64, albedo: f64) -> Vec<f64> {
    let between = |pair: &[(f64, f64)]| {
        let [low, high] = [pair[0].0, pair[1].0].map(|m| m * m);
        // In x = 1/k², measured from the pole below.
        let excess = |offset: f64| {
            let term = |&(m, w): &(f64, f64)| w * (low + offset) / (offset + (low - m * m));
            albedo * ordinates.iter().map(term).sum::<f64>() - 1.0
        };
        let (mut below, mut above) = (0.0, high - low);
        for _ in 0..100 {
            let middle = 0.5 * (below + above);
            if excess(middle) > 0.0 { below = middle } else { above = middle }
        }
        1.0 / (low + below).sqrt()
    };
    std::iter::once(kappa).chain(ordinates.windows(2).rev().map(between)).collect()
}

impl Sphere {
    /// A sphere of optical radius `radius` in which the share `absorbed_share` in (0, 1) is absorbed at each collision.
    #[allow(dead_code)] // The table is made over κ; tests ask by the share.
    pub fn of_share(absorbed_share: f64, radius: f64) -> Self {
        let ordinates = ordinates();
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..100 {
            let middle = 0.5 * (low + high);
            // 1 − ω with the digits of κ².
            let term = |&(m, w): &(f64, f64)| w * (middle * m).powi(2) / (1.0 - (middle * m).powi(2));
            let absorbed = albedo(&ordinates, middle) * ordinates.iter().map(term).sum::<f64>();
            if absorbed < absorbed_share { low = middle } else { high = middle }
        }
        Self::new(low, radius)
    }

    /// e^(−κR), which [`Sphere::leaving`] is to be multiplied by.
    #[allow(dead_code)]
    pub fn scale(&self) -> f64 {
        (-self.rates[0] * self.radius).exp()
    }

    /// A sphere of optical radius `radius` in which light decays at the rate `kappa` in (0, 1), per mean free path.
    pub fn new(kappa: f64, radius: f64) -> Self {
        let ordinates = ordinates();
        let albedo = albedo(&ordinates, kappa);
        let rates = rates(&ordinates, kappa, albedo);
        let n = ordinates.len();
        let rows = |f: &dyn Fn(f64) -> f64| DVector::from_fn(n, |i, _| f(ordinates[i].0));
        let matrix = |f: &dyn Fn(usize, f64) -> f64| DMatrix::from_fn(n, n, |i, j| f(j, ordinates[i].0));

        // At the centre. The first factor scales rows to comparable size.
        let source = rows(&|_| 1.0 / (4.0 * PI));
        let at_centre = matrix(&|j, m| albedo * m * m / (1.0 - (rates[j] * m).powi(2)));
        let both = at_centre.lu().solve(&source).expect("the modes are independent");

        // At the surface: nothing comes in.
        let fades = |j: usize| (-(rates[j] - kappa) * radius).exp();
        let comes_in = rows(&|m| -(0..n).map(|j| both[j] * fades(j) / (1.0 + rates[j] * m)).sum::<f64>());
        let at_surface = matrix(&|j, m| {
            let k = rates[j];
            let across = (-2.0 * k * radius).exp();
            if j == 0 {
                // sinh(κR)/κ + m cosh(κR), times e^(−κR).
                let sinh_over = -0.5 * (-2.0 * k * radius).exp_m1() / k;
                return (sinh_over + 0.5 * m * (1.0 + across)) / (1.0 - k * k * m * m);
            }
            1.0 / (1.0 - k * m) - across / (1.0 + k * m)
        });
        let inward = at_surface.lu().solve(&comes_in).expect("the modes are independent");
        Self {
            ordinates,
            radius,
            albedo,
            rates,
            outward: both.as_slice().to_vec(),
            inward: inward.as_slice().to_vec(),
        }
    }

    /// ψ without what comes straight from the source, times e^(κR), at distance `r` from the centre and `depth` = R − r
    /// below the surface.
    fn collided(&self, r: f64, depth: f64) -> f64 {
        let kappa = self.rates[0];
        let first = self.outward[0] * (kappa * depth).exp()
            - 0.5 * self.inward[0] * (-kappa * depth).exp() * (-2.0 * kappa * r).exp_m1() / kappa;
        let others = (1..self.rates.len()).map(|j| {
            let k = self.rates[j];
            // b (e^(−k(R−r)) − e^(−k(R+r))): what the odd continuation adds is in it.
            self.outward[j] * (kappa * self.radius - k * r).exp()
                - self.inward[j] * (-k * depth).exp() * (-2.0 * k * r).exp_m1()
        });
        // q(r) as the quadrature has it.
        let direct = |&(m, w): &(f64, f64)| w * (kappa * self.radius - r / m).exp() / (4.0 * PI * m * m);
        first + others.sum::<f64>() - self.ordinates.iter().map(direct).sum::<f64>()
    }
    /// Light that leaves after a collision, per unit of `angle` between its direction and the normal, times e^(κR):
    /// 2πωR² sin θ cos θ ∫ φ e^(−s) ds along the chord that ends there (s being the way to the end).
    pub fn leaving(&self, angle: f64) -> f64 {
        let (sin, cos) = angle.sin_cos();
        let (half, impact) = (self.radius * cos, self.radius * sin);
        // `along` is counted from the middle of the chord; `to_end` = `half` − |`along`| keeps its digits.
        let fluence = |along: f64, to_end: f64| {
            let r = along.hypot(impact);
            let depth = to_end * (2.0 * half - to_end) / (self.radius + r);
            let direct = ((self.rates[0] - 1.0) * self.radius + depth).exp() / (4.0 * PI * r);
            (direct + self.collided(r, depth)) / r
        };
        let near = double_exponential(half.min(OPAQUE), |to_end, rest| {
            let along = if half > OPAQUE { half - to_end } else { rest };
            fluence(along, to_end) * (-to_end).exp()
        });
        let far = double_exponential(half, |to_end, along| {
            let way = half + along;
            if way > OPAQUE { 0.0 } else { fluence(along, to_end) * (-way).exp() }
        });
        TAU * self.albedo * self.radius * self.radius * sin * cos * (near + far)
    }
}

/// ∫_0^`length` of `f`, which is given the distances from both ends. The rule of Takahasi and Mori 1974, which does not
/// mind what `f` does at the ends.
fn double_exponential(length: f64, f: impl Fn(f64, f64) -> f64) -> f64 {
    const STEPS: i32 = 60;
    const STEP: f64 = 3.2 / STEPS as f64;
    let term = |i: i32| {
        let t = STEP * f64::from(i);
        let stretched = FRAC_PI_2 * t.sinh();
        let (from_start, from_end) =
            (length / (1.0 + (-2.0 * stretched).exp()), length / (1.0 + (2.0 * stretched).exp()));
        let weight = FRAC_PI_2 * t.cosh() / (2.0 * stretched.cosh().powi(2));
        weight * f(from_start, from_end)
    };
    length * STEP * (-STEPS..=STEPS).map(term).sum::<f64>()
}
