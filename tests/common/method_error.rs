//! How far a method is from the walk in a picture, noise apart.

use alabaster::scene::{Method, Scene};
use alabaster::transport::{Counters, RenderOptions, Renderer};
use rayon::prelude::*;

use super::scenes::{Caster, caster, options};

/// Independent groups of samples, from whose spread the noise is known.
const GROUPS: usize = 16;

/// A picture of the pixels that show a material, made in groups that have no samples in common.
pub struct Groups {
    renderer: Renderer<Caster>,
    pixels: Vec<(u32, u32)>,
    samples: u64,
    /// By group: for each pixel and channel the sum of all samples.
    sums: Vec<Vec<f64>>,
}

/// An error by channel, in the unit of the picture, and what it is relative to.
#[derive(Clone, Copy, Debug, Default)]
pub struct ChannelError {
    /// Mean square over pixels of the difference, less noise; below 0 by chance.
    pub square: f64,
    /// Standard error of it.
    pub square_sigma: f64,
    /// Mean of the difference.
    pub bias: f64,
    /// Mean square over pixels of the reference, less noise.
    pub reference: f64,
}

impl Groups {
    /// No samples yet of `scene` by `method`, of the pixels that show `material` at their centre.
    pub fn new(scene: &Scene, method: Method, material: usize) -> Self {
        let renderer = Renderer::new(scene.clone(), RenderOptions { method, ..options() }, caster).unwrap();
        let (width, height) = (scene.film.width, scene.film.height);
        let pixels: Vec<_> = (0..height)
            .flat_map(|y| (0..width).map(move |x| (x, y)))
            .filter(|&(x, y)| renderer.material_seen(x, y) == Some(material))
            .collect();
        assert!(!pixels.is_empty(), "nothing to be seen");
        let sums = vec![vec![0.0; 3 * pixels.len()]; GROUPS];
        Self { renderer, pixels, samples: 0, sums }
    }

    /// Takes samples until each pixel has `samples` in each group.
    pub fn extend_to(&mut self, samples: u64) {
        let taken = self.samples;
        for (group, sums) in self.sums.iter_mut().enumerate() {
            // The same for all methods: what the boundary reflects is then no part of the difference, nor is its noise.
            self.renderer.reseed(group as u64);
            let renderer = &self.renderer;
            self.pixels.par_iter().zip(sums.par_chunks_exact_mut(3)).for_each(|(&(x, y), sum)| {
                let mut counters = Counters::default();
                for sample in taken..samples {
                    let radiance = renderer.sample(x, y, sample, &mut counters);
                    sum.iter_mut().zip(radiance.0).for_each(|(sum, x)| *sum += f64::from(x));
                }
            });
        }
        self.samples = samples.max(taken);
    }

    /// Samples of each pixel in each group.
    pub fn samples(&self) -> u64 {
        self.samples
    }

    /// The error of this picture against `reference`, by channel.
    pub fn error(&self, reference: &Self) -> [ChannelError; 3] {
        [0, 1, 2].map(|channel| {
            let values = |groups: &Self, group: usize| -> Vec<f64> {
                let sums = groups.sums[group].iter().skip(channel).step_by(3);
                sums.map(|sum| sum / groups.samples as f64).collect()
            };
            let truth: Vec<Vec<f64>> = (0..GROUPS).map(|group| values(reference, group)).collect();
            let difference = |group: usize| -> Vec<f64> {
                values(self, group).iter().zip(&truth[group]).map(|(a, r)| a - r).collect()
            };
            let differences: Vec<Vec<f64>> = (0..GROUPS).map(difference).collect();
            let (square, square_sigma) = mean_square(&differences);
            let count = (GROUPS * self.pixels.len()) as f64;
            let bias = differences.iter().flatten().sum::<f64>() / count;
            ChannelError { square, square_sigma, bias, reference: mean_square(&truth).0 }
        })
    }
}

/// Mean over pixels of the square of the mean over groups, less what noise adds to it: the mean product of different groups.
/// With its standard error by the jackknife.
fn mean_square(groups: &[Vec<f64>]) -> (f64, f64) {
    let pixels = groups[0].len();
    let sum = |p: usize| groups.iter().map(|group| group[p]).sum::<f64>();
    let squares = |p: usize| groups.iter().map(|group| group[p] * group[p]).sum::<f64>();
    let estimate = |without: Option<usize>| {
        let count = (groups.len() - usize::from(without.is_some())) as f64;
        let total: f64 = (0..pixels)
            .map(|p| {
                let left_out = without.map_or(0.0, |group| groups[group][p]);
                let (sum, squares) = (sum(p) - left_out, squares(p) - left_out * left_out);
                (sum * sum - squares) / (count * (count - 1.0))
            })
            .sum();
        total / pixels as f64
    };
    let parts: Vec<f64> = (0..groups.len()).map(|group| estimate(Some(group))).collect();
    let count = parts.len() as f64;
    let mean = parts.iter().sum::<f64>() / count;
    let spread: f64 = parts.iter().map(|x| (x - mean).powi(2)).sum();
    (estimate(None), (spread * (count - 1.0) / count).sqrt())
}
