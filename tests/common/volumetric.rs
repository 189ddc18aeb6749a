//! Comparison with an independent volumetric path tracer: radiance and standard errors in
//! `tests/data/volumetric`, with the scenes they were made from.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use alabaster::film::Film;
use alabaster::scene::{ProfileChoice, Scene, read_scene};
use alabaster::transport::{Counters, Renderer};

use super::cpu_time::thread_seconds;
use super::scenes::{Caster, renderer_with};
use super::walks::walker;

/// Offset in the denominator of relMSE, so that dark pixels count by their absolute error.
const OFFSET: f64 = 0.01;

/// Share of the object's mean that a lit pixel has at least. In darker ones some rare paths bring the light: their mean
/// over hundreds of samples is not yet normally distributed.
const LIT: f64 = 0.1;

/// Independent truth, in row-major pixels from the top.
pub struct Reference {
    pub scene: Scene,
    pub pixels: Vec<ReferencePixel>,
}

/// Mean radiance over a pixel.
pub struct ReferencePixel {
    pub mean: [f64; 3],
    pub standard_error: [f64; 3],
    /// Share of the pixel that the object covers.
    pub coverage: f64,
}

/// How a picture differs from the reference.
#[derive(Debug)]
pub struct Comparison {
    /// Mean of (x − ref)²/(ref² + 0.01) over pixels that the object covers at least in part, and channels.
    pub relative_mse: f64,
    /// The same over the whole picture.
    pub relative_mse_of_picture: f64,
    /// Mean over the pixels that the object covers whole, by channel.
    pub object_mean: [f64; 3],
    /// What it should be.
    pub reference_mean: [f64; 3],
    /// Standard error of the difference of the two, by channel.
    pub standard_error: [f64; 3],
    /// Processor time of sampling, one thread, s.
    pub cpu_seconds: f64,
}

impl Comparison {
    /// Relative error of the object's mean in a channel, and its standard error.
    pub fn bias(&self, channel: usize) -> (f64, f64) {
        let reference = self.reference_mean[channel];
        (self.object_mean[channel] / reference - 1.0, self.standard_error[channel] / reference)
    }
}

/// The scene `name` and its reference, both from the repository.
pub fn read(name: &str) -> Reference {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/volumetric");
    let scene = read_scene(&folder.join(format!("{name}.toml"))).unwrap();
    let pixels = read_pixels(&folder.join(format!("{name}.csv")));
    assert_eq!(pixels.len() as u64, u64::from(scene.film.width) * u64::from(scene.film.height));
    Reference { scene, pixels }
}

fn read_pixels(path: &PathBuf) -> Vec<ReferencePixel> {
    let table = fs::read_to_string(path).unwrap();
    let rows = table.lines().filter(|line| !line.starts_with('#')).skip(1);
    rows.map(|row| {
        let fields: Vec<f64> = row.split(',').map(|field| field.parse().unwrap()).collect();
        let [r, g, b, sr, sg, sb, coverage] = fields[..] else { panic!("{row}") };
        ReferencePixel { mean: [r, g, b], standard_error: [sr, sg, sb], coverage }
    })
    .collect()
}

/// Renders the scene of `reference` with a profile, on one thread, and compares.
pub fn compare(reference: &Reference, profile: ProfileChoice, samples: u64) -> Comparison {
    let renderer = renderer_with(reference.scene.clone(), profile);
    let (film, cpu_seconds) = render(&renderer, samples);
    compare_film(reference, &film, cpu_seconds)
}

/// The same by random walks, and the differences in the pixels that the object covers whole and that are [`LIT`], each
/// channel of each in units of its standard error (the picture's and the reference's together).
pub fn compare_walk(reference: &Reference, samples: u64) -> (Comparison, Vec<f64>) {
    let renderer = walker(reference.scene.clone());
    let (film, cpu_seconds) = render(&renderer, samples);
    let comparison = compare_film(reference, &film, cpu_seconds);
    let mut pulls = Vec::new();
    for (pixel, truth) in film.rows().zip(&reference.pixels).filter(|(_, truth)| truth.coverage == 1.0) {
        for c in (0..3).filter(|&c| truth.mean[c] >= LIT * comparison.reference_mean[c]) {
            let sigma = pixel.variance_of_mean(c).sqrt().hypot(truth.standard_error[c]);
            pulls.push((f64::from(pixel.mean()[c]) - truth.mean[c]) / sigma);
        }
    }
    (comparison, pulls)
}

fn compare_film(reference: &Reference, film: &Film, cpu_seconds: f64) -> Comparison {
    let mut comparison = Comparison {
        relative_mse: 0.0,
        relative_mse_of_picture: 0.0,
        object_mean: [0.0; 3],
        reference_mean: [0.0; 3],
        standard_error: [0.0; 3],
        cpu_seconds,
    };
    let (mut whole, mut touched) = (0.0, 0.0);
    for (pixel, truth) in film.rows().zip(&reference.pixels) {
        touched += f64::from(u8::from(truth.coverage > 0.0));
        whole += f64::from(u8::from(truth.coverage == 1.0));
        for c in 0..3 {
            let value = f64::from(pixel.mean()[c]);
            let error = (value - truth.mean[c]).powi(2) / (truth.mean[c].powi(2) + OFFSET) / 3.0;
            comparison.relative_mse_of_picture += error;
            if truth.coverage > 0.0 {
                comparison.relative_mse += error;
            }
            if truth.coverage == 1.0 {
                comparison.object_mean[c] += value;
                comparison.reference_mean[c] += truth.mean[c];
                comparison.standard_error[c] += pixel.variance_of_mean(c) + truth.standard_error[c].powi(2);
            }
        }
    }
    comparison.relative_mse /= touched;
    comparison.relative_mse_of_picture /= reference.pixels.len() as f64;
    comparison.object_mean = comparison.object_mean.map(|x| x / whole);
    comparison.reference_mean = comparison.reference_mean.map(|x| x / whole);
    comparison.standard_error = comparison.standard_error.map(|x| x.sqrt() / whole);
    comparison
}

/// A film with `samples` samples per pixel, and the processor time in seconds, on one thread.
pub fn render(renderer: &Renderer<Caster>, samples: u64) -> (Film, f64) {
    let size = renderer.scene().film;
    let mut film = Film::new(size.width, size.height).unwrap();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let seconds = pool.install(|| {
        let start = thread_seconds();
        film.accumulate(
            0..samples,
            |x, y, sample, counters: &mut Counters| renderer.sample(x, y, sample, counters),
            |_, _| (),
            &AtomicBool::new(false),
            |_| (),
        );
        thread_seconds() - start
    });
    (film, seconds)
}
