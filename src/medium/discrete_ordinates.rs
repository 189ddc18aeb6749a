//! The equation of transfer in a flat medium with a Henyey–Greenstein phase function, by the method of
//! discrete ordinates, for what does not depend on azimuth.
//!
//! On cosines ±μ_i with weights w_i the equation μ dI/dτ = I − S becomes a system of ordinary
//! differential equations (Chandrasekhar 1960, chapter VI; Stamnes et al. 1988, "Numerically stable
//! algorithm for discrete-ordinate-method radiative transfer"). It is written here in the polynomials
//! p_l that are orthonormal *on the nodes*, for which μ p_l = β_{l+1} p_{l+1} + β_l p_{l−1}: with
//! I = Σ ψ_l p_l,
//!
//! β_{l+1} ψ'_{l+1} + β_l ψ'_{l−1} = h_l ψ_l,   h_l = 1 − ω g^l.
//!
//! For the degrees that the quadrature integrates these are Legendre's polynomials, so that g^l is the
//! moment of the phase function. Scattering then conserves energy to the last digit, the eigenvalue
//! problem is symmetric and tridiagonal, and the absorbed share enters as it is given, as h_0 = 1 − ω:
//! no digit is lost as ω → 1.

use nalgebra::{DMatrix, DVector, SymmetricEigen};

use crate::math::quadrature::GaussLegendre;

/// Least absorbed share that is told from 0: the albedo then differs from 1 by less than 10⁻¹⁰.
const LEAST_ABSORBED_SHARE: f64 = 1e-24;

/// Iterations for all eigenvalues; the solver takes about two for each.
const EIGENVALUE_ITERATIONS: usize = 10_000;

/// What the eigenvalue solver takes for 0. It compares with the largest element too, which may be 10²⁴
/// times others that must keep their digits; convergence is cubic, so that a tiny bound costs little.
const NEGLIGIBLE: f64 = 1e-60;

/// Nodes and the polynomials orthonormal on them.
#[derive(Clone, Debug)]
pub(super) struct Ordinates {
    /// Cosines μ_i in (0, 1).
    pub mu: Vec<f64>,
    /// Square roots of the weights, which sum to 1.
    pub root_weight: Vec<f64>,
    /// √w_i p_l(μ_i) for even degree l (column l/2).
    pub even: DMatrix<f64>,
    /// √w_i p_l(μ_i) for odd degree l (column (l−1)/2).
    pub odd: DMatrix<f64>,
    /// β_l, with β_0 = 0.
    pub beta: Vec<f64>,
}

impl Ordinates {
    /// `count` Gauss–Legendre nodes, some below the cosine `critical` and the others above it, where
    /// μ = μ_c + (1 − μ_c)x² removes the square root with which Fresnel's reflectance leaves 1.
    pub fn new(critical: f64, count: usize) -> Self {
        let span = 1.0 - critical;
        // In proportion to what they cover, with two for the narrowest range.
        let below = if critical > 0.0 { (0.6 * count as f64 * critical) as usize + 2 } else { 0 };
        let (below, above) = (GaussLegendre::new(below), GaussLegendre::new(count - below));
        let below = below.nodes().iter().map(|&(x, w)| (critical * x, critical * w));
        let above = above.nodes().iter().map(|&(x, w)| (critical + span * x * x, 2.0 * span * x * w));
        let (mu, root_weight): (Vec<_>, Vec<_>) = below.chain(above).map(|(mu, w)| (mu, w.sqrt())).unzip();
        let (even, odd, beta) = orthonormal_polynomials(&mu, &root_weight);
        Self { mu, root_weight, even, odd, beta }
    }

    /// Number of nodes, and of polynomials of either parity.
    pub fn len(&self) -> usize {
        self.mu.len()
    }
}

/// The polynomials orthonormal on ±μ_i, those of even and those of odd degree, times √w; and β_l.
///
/// Multiplication by μ takes even polynomials to odd ones and back: the bidiagonalisation of Golub
/// and Kahan (1965), with each new column made orthogonal to all before it.
fn orthonormal_polynomials(mu: &[f64], root_weight: &[f64]) -> (DMatrix<f64>, DMatrix<f64>, Vec<f64>) {
    let n = mu.len();
    let mu = DVector::from_column_slice(mu);
    let mut columns = [DMatrix::zeros(n, n), DMatrix::zeros(n, n)];
    let mut beta = vec![0.0];
    columns[0].set_column(0, &DVector::from_column_slice(root_weight));
    for degree in 1..2 * n {
        let mut next = mu.component_mul(&columns[(degree - 1) % 2].column((degree - 1) / 2));
        let known = columns[degree % 2].columns(0, degree / 2);
        // Twice is enough (Giraud et al. 2005).
        for _ in 0..2 {
            next -= known * known.tr_mul(&next);
        }
        beta.push(next.norm());
        columns[degree % 2].set_column(degree / 2, &next.normalize());
    }
    let [even, odd] = columns;
    (even, odd, beta)
}

/// The solutions of the equation of transfer that decay with depth as e^(−kτ).
#[derive(Clone, Debug)]
pub(super) struct Modes {
    /// Decay rates k; positive.
    pub rate: Vec<f64>,
    /// ψ_l of even degree l (row l/2) of each mode (column).
    pub even: DMatrix<f64>,
    /// ψ_l of odd degree l (row (l−1)/2).
    pub odd: DMatrix<f64>,
    /// h_l.
    pub loss: Vec<f64>,
    /// Optical depth τ here over that of the medium.
    pub optical_scale: f64,
}

impl Modes {
    /// For the share `absorbed_share` = 1 − ω of each collision and mean cosine `g`. All rates are NaN if
    /// the arguments are.
    ///
    /// What scatters by less than the quadrature resolves counts as not scattered (the δ-M method,
    /// Wiscombe 1977): with f = |g|^L, L the number of moments kept, all of h_l is divided by 1 − ωf.
    pub fn new(ordinates: &Ordinates, absorbed_share: f64, g: f64) -> Self {
        let n = ordinates.len();
        let absorbed = absorbed_share.clamp(LEAST_ABSORBED_SHARE, 1.0);
        let h = |moment: f64| (1.0 - moment) + absorbed * moment;
        let optical_scale = h(g.abs().powi(2 * n as i32));
        let loss: Vec<_> = (0..2 * n as i32).map(|l| h(g.powi(l)) / optical_scale).collect();
        let (inverse_square, vectors) = eigen(&ordinates.beta, &loss);
        let rate: Vec<_> = inverse_square.iter().map(|x| 1.0 / x.sqrt()).collect();
        let odd = DMatrix::from_fn(n, n, |i, j| vectors[(i, j)] / loss[2 * i + 1].sqrt());
        let even = DMatrix::from_fn(n, n, |i, j| even_degree(&ordinates.beta, &loss, &odd, rate[j], i, j));
        Self { rate, even, odd, loss, optical_scale }
    }
}

/// 1/k² and φ_l for odd l, where φ_l = √h_l ψ_l.
///
/// A mode is Tφ = −φ/k with t_l = β_l/√(h_{l−1} h_l) beside the diagonal of T and zeros on it, so
/// T²φ = φ/k², which odd degrees satisfy by themselves. There h_0 stands in one corner alone, and the
/// other eigenvalues keep their digits when it is tiny.
fn eigen(beta: &[f64], loss: &[f64]) -> (DVector<f64>, DMatrix<f64>) {
    let n = loss.len() / 2;
    let t = |l: usize| if l < 2 * n { beta[l] / (loss[l - 1] * loss[l]).sqrt() } else { 0.0 };
    let square = DMatrix::from_fn(n, n, |i, j| {
        let l = 2 * i.max(j);
        match i.abs_diff(j) {
            0 => t(l + 1) * t(l + 1) + t(l + 2) * t(l + 2),
            1 => t(l) * t(l + 1),
            _ => 0.0,
        }
    });
    let decomposition = if square.iter().all(|x| x.is_finite()) {
        SymmetricEigen::try_new(square, NEGLIGIBLE, EIGENVALUE_ITERATIONS)
    } else {
        None
    };
    match decomposition {
        // Rounding may leave the least of them, of directions along the surface, below 0.
        Some(eigen) => (eigen.eigenvalues.map(|x| x.max(f64::EPSILON * f64::EPSILON)), eigen.eigenvectors),
        None => (DVector::from_element(n, f64::NAN), DMatrix::from_element(n, n, f64::NAN)),
    }
}

/// ψ_l of degree l = 2`i` of mode `j` from the odd ones: −k(β_{l+1}ψ_{l+1} + β_lψ_{l−1}) = h_l ψ_l, but
/// for l = 0 the equation of degree 1, which does not divide by h_0.
fn even_degree(beta: &[f64], loss: &[f64], odd: &DMatrix<f64>, k: f64, i: usize, j: usize) -> f64 {
    let at = |i: usize| -k * (beta[2 * i + 1] * odd[(i, j)] + beta[2 * i] * odd[(i - 1, j)]) / loss[2 * i];
    match i {
        0 => -(loss[1] * odd[(0, j)] / k + beta[2] * at(1)) / beta[1],
        _ => at(i),
    }
}
