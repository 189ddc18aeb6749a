//! The Neumann series of the light in a picture: L = E + KE + K²E + …, order by order.
//!
//! A path that is cut after k bounces is the same as one that goes on, up to there. So the order K^k E is the difference of two
//! pictures of the same samples, cut after k and after k − 1 bounces, and its noise is that of its own light alone.
//! A bounce is a meeting with a surface, or a way under one that the area integral takes at once.

use rayon::prelude::*;
use serde::Serialize;

use crate::raycast::RayCaster;
use crate::transport::{Counters, Renderer};

/// Added to the seed of the picture that the sum is held against.
const OTHER_SEED: u64 = 0x9e37_79b9;

/// A mean over the picture and its standard error, W/(m² sr), channels averaged.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Mean {
    /// The mean.
    pub value: f64,
    /// One σ.
    pub stderr: f64,
}

/// One order.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Order {
    /// k of K^k E.
    pub order: u32,
    /// What it adds.
    pub radiance: Mean,
    /// That as a share of all orders.
    pub share: f64,
    /// What is lost if paths are cut after it, as a share of all orders.
    pub lost_if_cut: f64,
}

/// All orders.
#[derive(Clone, Debug, Serialize)]
pub struct Orders {
    /// Samples per pixel.
    pub spp: u32,
    /// From 0, what emits, on.
    pub orders: Vec<Order>,
    /// The sum of those beyond.
    pub beyond: Mean,
    /// The sum of all.
    pub sum: Mean,
    /// The whole picture, by other samples.
    pub whole: Mean,
}

impl Orders {
    /// How far the sum is from the whole, in standard errors of the difference.
    pub fn sigmas(&self) -> f64 {
        let error = self.sum.stderr.hypot(self.whole.stderr);
        let difference = (self.sum.value - self.whole.value).abs();
        if difference > 0.0 { difference / error } else { 0.0 }
    }
}

/// The orders from 0 to `highest` in the picture of `renderer`'s scene, of `spp` samples per pixel (2 at least, for errors). It is left with
/// another seed.
pub fn neumann_orders<C: RayCaster>(renderer: &mut Renderer<C>, spp: u32, highest: u32, seed: u64) -> Orders {
    let (limit, spp) = (renderer.depth_limit(), spp.max(2));
    renderer.reseed(seed);
    let mut below = vec![0.0; sample_count(renderer, spp)];
    let mut terms = Vec::new();
    for order in (0..=highest).take_while(|&order| limit.is_none_or(|limit| order <= limit)) {
        renderer.limit_depth(Some(order));
        let upto = samples(renderer, spp);
        terms.push((order, mean(&upto, Some(&below), spp)));
        below = upto;
    }
    renderer.limit_depth(limit);
    let all = samples(renderer, spp);
    let beyond = mean(&all, Some(&below), spp);
    let sum = mean(&all, None, spp);
    renderer.reseed(seed.wrapping_add(OTHER_SEED));
    let whole = mean(&samples(renderer, spp), None, spp);
    let share = |value: f64| if sum.value > 0.0 { value / sum.value } else { 0.0 };
    let mut reached = 0.0;
    let orders = terms.into_iter().map(|(order, radiance)| {
        reached += radiance.value;
        Order { order, radiance, share: share(radiance.value), lost_if_cut: share(sum.value - reached) }
    });
    Orders { spp, orders: orders.collect(), beyond, sum, whole }
}

fn sample_count<C: RayCaster>(renderer: &Renderer<C>, spp: u32) -> usize {
    let film = renderer.scene().film;
    film.width as usize * film.height as usize * spp as usize
}

/// Every sample of every pixel, channels averaged; what is not finite counts as nothing, as on film.
fn samples<C: RayCaster>(renderer: &Renderer<C>, spp: u32) -> Vec<f64> {
    let width = renderer.scene().film.width as usize;
    let value = |i: usize| {
        let (pixel, sample) = (i / spp as usize, i % spp as usize);
        let (x, y) = ((pixel % width) as u32, (pixel / width) as u32);
        let radiance = renderer.sample(x, y, sample as u64, &mut Counters::default());
        if radiance.is_finite() { f64::from(radiance.mean()) } else { 0.0 }
    };
    (0..sample_count(renderer, spp)).into_par_iter().map(value).collect()
}

/// The mean of `samples` less `others`, and its error by the variance within pixels.
fn mean(samples: &[f64], others: Option<&[f64]>, spp: u32) -> Mean {
    let (mut total, mut variance, count) = (0.0, 0.0, f64::from(spp));
    for (pixel, samples) in samples.chunks(spp as usize).enumerate() {
        let at = |i: usize| samples[i] - others.map_or(0.0, |others| others[pixel * spp as usize + i]);
        let sum: f64 = (0..samples.len()).map(at).sum();
        let squares: f64 = (0..samples.len()).map(|i| (at(i) - sum / count).powi(2)).sum();
        total += sum;
        variance += squares / (count - 1.0) * count;
    }
    let all = samples.len().max(1) as f64;
    Mean { value: total / all, stderr: variance.sqrt() / all }
}
