//! Media at the ends of their ranges: white, black, clear, forward-peaked, thin, unequal in their channels.

use alabaster::diffusion::{BetterDipole, BoundaryMoments, DiffusionModel, HalfSpace};
use alabaster::math::sampler::HashGenerator;
use alabaster::medium::dwivedi::Mode;
use alabaster::medium::presets::measured_material;
use alabaster::medium::{Entry, Medium, PlaneParallel};
use alabaster::optics::phase::HenyeyGreenstein;
use alabaster::radiometry::Rgb;
use alabaster::scene::{
    ColorInput, ColorMode, Environment, Material, Mesh, Method, ScatteringInput, Scene, Surface, shape,
};
use alabaster::transport::RenderOptions;
use glam::{Mat3, Vec3, Vec4};
use rayon::prelude::*;

use crate::common::backends::{Pictures, Rays, by, renderings, renderings_in};
use crate::common::scenes::{Statistics, furnace, white};
use crate::record::{Figures, Largest, assert_fails, record};
use crate::table::{number, rows};

/// A material of coefficients per channel.
pub fn translucent(ior: f32, sigma_a: Rgb, sigma_s: Rgb, g: f32) -> Material {
    let medium = ScatteringInput::Coefficients { sigma_a, sigma_s, g };
    Material { surface: Surface::Translucent { ior, roughness: 0.0, medium }, ..white(ior, 0.0, Rgb::ONE) }
}

/// A flat body of thickness 1 below y = 0, many free paths wide.
fn slab(material: Material) -> Scene {
    furnace(shape::cuboid(Vec3::NEG_Y * 0.5, Vec3::new(60.0, 1.0, 60.0)), material)
}

/// Rays straight down on it.
fn down(_: u64) -> (Vec3, Vec3) {
    (Vec3::new(1.3, 1.0, 0.4), Vec3::NEG_Y)
}

#[test]
fn albedo_towards_one() {
    // The share absorbed at a collision, from coefficients and from the albedo.
    let (mut kept, mut naive) = (0.0_f64, 0.0_f64);
    for row in rows("float32_hard_values.csv").iter().filter(|row| row[0].starts_with("one_minus_omega")) {
        let absorbed = number(&row[2]);
        let medium = Medium {
            sigma_a: Rgb::splat(absorbed as f32),
            sigma_s: Rgb::splat((1.0 - absorbed) as f32),
            g: 0.0,
        };
        let error = |share: f32| (f64::from(share) / absorbed - 1.0).abs();
        kept = kept.max(error(medium.absorbed_share_reduced()[0]));
        naive = naive.max(error(1.0 - (1.0 - absorbed) as f32));
    }
    // Rounding of the two coefficients, their sum and the quotient.
    let holds = |error: f64| error < 2.0 * f64::from(f32::EPSILON);
    assert!(holds(kept), "{kept}");
    assert_fails("1 − ω", naive, holds);

    // Better dipole: C_φ (1 − X)/m with m → 0.
    let model = |sigma_a: f64| BetterDipole::new(&HalfSpace::new(sigma_a, 1.0, 0.0, 1.5).unwrap()).albedo();
    assert!((model(0.0) - model(1e-12)).abs() < 1e-5, "{} {}", model(0.0), model(1e-12));
    let ratio =
        |m: f32| (1.0 - (-4.0 * BoundaryMoments::new(1.5).reflection_parameter() as f32 * m).exp()) / m;
    assert_fails("(1 − X)/m at albedo 1", ratio(0.0), f32::is_finite);

    // What neither comes back nor goes through is what is absorbed.
    let mut largest = 0.0_f64;
    for row in rows("slab_planar_RT.csv").iter().filter(|row| number(&row[1]) == 0.999_999) {
        let [tau, eta, r, t] = [0, 3, 4, 5].map(|column| number(&row[column]));
        let transport = PlaneParallel::new(eta, number(&row[2]));
        let found = transport.slab(1e-6, tau).reflectance_and_transmittance_at(1.0);
        largest =
            largest.max((found.0 - r).abs()).max((found.1 - t).abs()).max((1.0 - found.0 - found.1).abs());
    }
    assert!(largest < 1e-4, "{largest}");

    let mut furnace_error = Largest::default();
    // Of a path of at most some n²·2R = 4.5 in the sphere the share σ_a is absorbed; the area integral takes it for a half-space.
    let half_space = PlaneParallel::new(1.5, 0.0).half_space(1e-8).reflectance(Entry::Diffuse);
    for (method, sigma_a, absorbed) in [(Method::Walk, 1e-5, 1e-4), (Method::Bssrdf, 8e-8, 1.0 - half_space)]
    {
        let scene = furnace(
            shape::sphere(Vec3::ZERO, 1.0, 5),
            translucent(1.5, Rgb::splat(sigma_a), Rgb::new(10.0, 8.0, 16.0), 0.0),
        );
        for (setup, found) in renderings(&scene, by(method), &Pictures(12)) {
            let (mean, sigma) = (found.mean.mean(), found.mean.standard_error());
            assert!((mean - 1.0).abs() < 3.0 * sigma + absorbed, "{method:?} {setup}: {mean} ± {sigma}");
            // The mean of the channels hardly varies at all; the luminance of wavelengths does.
            assert!((mean - 1.0).abs() < f64::max(1e-3, 3.0 * sigma), "{method:?} {setup}: {mean}");
            furnace_error.add(setup, (mean - 1.0).abs());
        }
    }
    record(
        "albedo_towards_one",
        format!(
            "1 − ω: {kept:.0e}, naive {naive:.0e}; slabs: {largest:.0e}; furnace: {}",
            furnace_error.written()
        ),
    );
}

#[test]
fn albedo_towards_zero() {
    // The eigenvalue of diffusion is 1 up to 4·10⁻⁹ there.
    let exact =
        rows("diffusion_length.csv").iter().find(|row| row[0] == "0.1").map(|row| number(&row[1])).unwrap();
    let naive = |nu: f32| 1.0 / ((nu - 1.0) * ((nu + 1.0) / (nu - 1.0)).ln());
    let holds = |density: f32| density.is_finite() && density > 0.0;
    assert!(holds(Mode::new(0.1).density(1.0)) && holds(Mode::new(0.0).density(1.0)));
    assert_fails("Dwivedi's density with ν₀ in single precision", naive(exact as f32), holds);

    let table = rows("halfspace_H_albedo.csv");
    let reflectance = table.iter().find(|row| row[0] == "0.1").map(|row| number(&row[1])).unwrap();
    let mut figure = Figures::default();
    for (mode, albedos) in [
        (ColorMode::Rgb, [0.0, 1e-8, 0.1]),
        (ColorMode::Rgb, [1e-30, 0.01, 0.1]),
        (ColorMode::Spectral, [0.0; 3]),
        (ColorMode::Spectral, [1e-8; 3]),
        (ColorMode::Spectral, [0.1; 3]),
    ] {
        let albedo = Rgb::from_fn(|c| albedos[c]);
        let material = translucent(1.0, (Rgb::ONE - albedo) * 25.0, albedo * 25.0, 0.0);
        for method in [Method::Walk, Method::Bssrdf] {
            let work = Rays(200_000, down);
            for (setup, found) in renderings_in(mode, &slab(material.clone()), by(method), &work) {
                for (channel, albedo) in found.parts(mode).iter().zip(albedos) {
                    let (mean, sigma) = (channel.mean(), channel.standard_error());
                    // Of what is behind the slab e^−25 comes straight through.
                    assert!(
                        mean >= 0.0 && mean <= f64::from(albedo) + 3.0 * sigma + (-24.9_f64).exp(),
                        "{method:?} {setup}: {mean}"
                    );
                }
                let brightest = found.parts(mode).iter().zip(albedos).next_back();
                if let Some((channel, 0.1)) = brightest.filter(|_| method == Method::Walk) {
                    let (error, sigma) = (channel.mean() - reflectance, channel.standard_error());
                    assert!(error.abs() < 3.0 * sigma, "{setup}: {error}");
                    assert!(error.abs() < 1e-3, "{setup}: {error}");
                    figure.keep(setup, format!("R(0.1) − exact: {error:+.0e} ± {sigma:.0e}"));
                }
            }
        }
    }
    record("albedo_towards_zero", figure.written());
}

#[test]
fn forward_peaked_phase_functions() {
    let (mut density, mut naive_density, mut cosine) = (0.0_f64, 0.0_f64, 0.0_f64);
    for row in rows("hg_phase.csv") {
        let g = number(&row[0]);
        let phase = HenyeyGreenstein { g };
        for (cos, column) in [(1.0, 1), (0.0, 2), (-1.0, 3)] {
            let exact = number(&row[column]);
            density = density.max((phase.density(cos) / exact - 1.0).abs());
            let naive = textbook_density(g as f32, cos as f32);
            naive_density = naive_density.max((f64::from(naive) / exact - 1.0).abs());
        }
        // By equal steps of the random number: the cosine is monotone in it, so the mean is off by a step at most.
        const STEPS: u32 = 100_000;
        let mean = (0..STEPS).map(|i| phase.sample((f64::from(i) + 0.5) / f64::from(STEPS)).cos).sum::<f64>();
        cosine = cosine.max((mean / f64::from(STEPS) - g).abs());
        assert!(kolmogorov(phase) < 1.95, "g {g}");
    }
    // Twelve digits in the table.
    let holds = |error: f64| error < 1e-9;
    assert!(holds(density) && cosine < 1e-4, "{density} {cosine}");
    assert_fails("1 + g² − 2g cosθ", naive_density, holds);
    let (mut sample, mut naive_sample) = (0.0_f64, 0.0_f64);
    for row in rows("float32_hard_values.csv").iter().filter(|row| row[0] == "hg_sample_f32") {
        let g: f32 = row[1].trim_start_matches("g=").trim_end_matches(" xi=.3").parse().unwrap();
        let exact = number(&row[2]);
        sample =
            sample.max((HenyeyGreenstein { g: f64::from(g) }.sample(f64::from(0.3_f32)).cos - exact).abs());
        naive_sample = naive_sample.max((f64::from(textbook_cosine(g, 0.3)) - exact).abs());
    }
    let holds = |error: f64| error < 1e-6;
    assert!(holds(sample), "{sample}");
    assert_fails("the textbook inverse", naive_sample, holds);
    record(
        "forward_peaked_phase_functions",
        format!(
            "density {density:.0e}, naive {naive_density:.0e}; mean cosine {cosine:.0e}; \
             cosine {sample:.0e}, naive {naive_sample:.0e}"
        ),
    );
}

fn textbook_density(g: f32, cos: f32) -> f32 {
    (1.0 - g * g) / (4.0 * std::f32::consts::PI * (1.0 + g * g - 2.0 * g * cos).powf(1.5))
}

fn textbook_cosine(g: f32, xi: f32) -> f32 {
    let ratio = (1.0 - g * g) / (1.0 - g + 2.0 * g * xi);
    (1.0 + g * g - ratio * ratio) / (2.0 * g)
}

/// The largest distance of drawn cosines from their distribution, times the root of their count: beyond 1.95 in one of a
/// thousand cases.
fn kolmogorov(phase: HenyeyGreenstein) -> f64 {
    const DRAWS: usize = 20_000;
    let mut random = HashGenerator::new(5);
    let g = phase.g;
    let mut below: Vec<f64> = (0..DRAWS)
        .map(|_| {
            let cos = phase.sample(f64::from(random.next_f32())).cos;
            // The cumulative distribution, in units where 1 + g² − 2g cosθ is a sum of terms of one sign.
            let spread = ((1.0 - g.abs()).powi(2) + 2.0 * g.abs() * (1.0 - cos * 1.0_f64.copysign(g))).sqrt();
            if g.abs() < 1e-3 {
                // ∫ (1 + 3gμ)/2 up to terms of g².
                return 0.5 * (1.0 + cos) + 0.75 * g * (cos * cos - 1.0);
            }
            (1.0 - g * g) / (2.0 * g) * (1.0 / spread - 1.0 / (1.0 + g))
        })
        .collect();
    below.sort_by(f64::total_cmp);
    let distance = |(i, x): (usize, &f64)| (x - (i as f64 + 0.5) / DRAWS as f64).abs();
    below.iter().enumerate().map(distance).fold(0.0, f64::max) * (DRAWS as f64).sqrt()
}

/// How many of `draws` free flights are longer than `distance` mean free paths, and the longest.
fn long_flights(draws: u64, distance: f32, flight: impl Fn(&mut HashGenerator) -> f32 + Sync) -> (u64, f32) {
    const PART: u64 = 1 << 20;
    let part = |part: u64| {
        let mut random = HashGenerator::new(part);
        let (mut count, mut longest) = (0, 0.0_f32);
        for _ in 0..PART {
            let flown = flight(&mut random);
            count += u64::from(flown > distance);
            longest = longest.max(flown);
        }
        (count, longest)
    };
    let join = |a: (u64, f32), b: (u64, f32)| (a.0 + b.0, a.1.max(b.1));
    (0..draws.div_ceil(PART)).into_par_iter().map(part).reduce(|| (0, 0.0), join)
}

fn check_tail(draws: u64, distance: f32) -> String {
    let expected = draws as f64 * (-f64::from(distance)).exp();
    let holds = |count: u64| (count as f64 - expected).abs() < 3.0 * expected.sqrt();
    let (count, longest) = long_flights(draws, distance, HashGenerator::next_exponential);
    assert!(holds(count), "{count} of {expected}");
    // 24 bits end at 24 ln 2 = 16.6.
    let (naive, end) = long_flights(draws, distance, |random| -(1.0 - random.next_f32()).ln());
    assert_fails("−ln(1 − u) with 24 bits", naive, holds);
    format!(
        "{count} of {expected:.1} expected flights beyond {distance}, longest {longest:.1}; naive {naive}, longest {end:.1}"
    )
}

#[test]
fn tail_of_free_flights() {
    record("tail_of_free_flights", check_tail(1 << 29, 16.75));
}

/// T = e^−20.
#[test]
#[ignore = "minutes: twenty thousand million flights"]
fn transmittance_of_twenty_free_paths() {
    println!("{}", check_tail(20 << 30, 20.0));
}

/// A sphere of ketchup, 5 mm in radius, in even light. No light is made, in no path: each channel carries at most what all three did.
#[test]
fn unequal_channels() {
    let mut figure = Figures::default();
    for name in ["Ketchup", "Skin1"] {
        let measured = measured_material(name).unwrap();
        let material = translucent(measured.ior, measured.sigma_a, measured.sigma_s_reduced, 0.0);
        let scene = furnace(shape::sphere(Vec3::ZERO, 5e-3, 4), material);
        let scene = Scene { camera: zoomed(&scene, 5e-3), ..scene };
        // Guided walks may weigh ten times as much, which is a bound of its own.
        let options = RenderOptions { guiding: false, ..by(Method::Walk) };
        for (setup, found) in renderings(&scene, options, &Pictures(64)) {
            let brightest = found.parts(setup.mode).iter().map(|part| part.max).fold(0.0, f64::max);
            // As many as share a path; some hundred roundings.
            let (channels, together) = if setup.mode == ColorMode::Rgb { (3.0, 1.0) } else { (4.0, 4.0) };
            let holds = |weight: f64| weight <= channels * (1.0 + 1e-5);
            assert!(holds(brightest) && found.mean.max <= together + 1e-5, "{name} {setup}: {brightest}");
            assert_eq!((found.counters.rejected, found.counters.capped_paths), (0, 0));
            let naive = largest_weight_by_one_channel(measured.sigma_a + measured.sigma_s_reduced);
            assert_fails("flights by one channel", naive, holds);
            figure.keep(setup, format!("largest weight {brightest:.3}, flights by one channel {naive:.1e}"));
        }
    }
    record("unequal_channels", figure.written());
}

fn zoomed(scene: &Scene, factor: f32) -> alabaster::scene::Camera {
    alabaster::scene::Camera { position: scene.camera.position * factor, ..scene.camera }
}

/// Flights drawn by the channel of the shortest free path alone, and weighted for the one of the longest: σ_i e^(−σ_i t) over the density,
/// without bound.
pub fn largest_weight_by_one_channel(sigma_t: Rgb) -> f64 {
    let mut random = HashGenerator::new(3);
    let (least, most) = (f64::from(sigma_t.min_component()), f64::from(sigma_t.max_component()));
    let weight = |t: f64| least / most * ((most - least) * t).exp();
    (0..100_000).map(|_| weight(f64::from(random.next_exponential()) / most)).fold(0.0, f64::max)
}

/// Nine decades between the channels of one medium, and one without any scattering.
#[test]
fn extreme_spectra() {
    let mesh = || shape::sphere(Vec3::ZERO, 1.0, 4);
    let mut farthest = Largest::default();
    for sigma_s in [[0.0, 1e-3, 1e3], [1e-4, 1.0, 1e3], [0.0, 0.0, 5.0]] {
        let scene = furnace(mesh(), translucent(1.4, Rgb::ZERO, Rgb::from_fn(|c| sigma_s[c]), 0.0));
        for method in [Method::Walk, Method::Bssrdf] {
            for (setup, found) in renderings(&scene, by(method), &Pictures(16)) {
                for channel in found.parts(setup.mode) {
                    let (mean, sigma) = (channel.mean(), channel.standard_error());
                    // Channels of several pictures: 4σ.
                    assert!(
                        (mean - 1.0).abs() < 4.0 * sigma + 1e-4,
                        "{sigma_s:?} {method:?} {setup}: {mean} ± {sigma}"
                    );
                }
                assert_eq!(found.counters.rejected, 0);
                let (mean, sigma) = (found.mean.mean(), found.mean.standard_error());
                assert!(
                    (mean - 1.0).abs() < 3.0 * sigma + 1e-4,
                    "{sigma_s:?} {method:?} {setup}: {mean} ± {sigma}"
                );
                farthest.add(setup, (mean - 1.0).abs());
            }
        }
    }
    // And with absorption that leaves nothing of one channel.
    let scene = furnace(mesh(), translucent(1.4, Rgb::new(0.0, 1e9, 1e-9), Rgb::new(1e3, 1.0, 1e-9), 0.9));
    for method in [Method::Walk, Method::Bssrdf] {
        for (setup, found) in renderings(&scene, by(method), &Pictures(4)) {
            let makes_none = |part: &Statistics| part.mean() < 1.0 + 4.0 * part.standard_error() + 1e-4;
            assert!(found.parts(setup.mode).iter().all(makes_none), "{method:?} {setup}");
        }
    }
    record("extreme_spectra", format!("furnace: {}", farthest.written()));
}

/// Light from above only: what a slab sends back is less than a half-space does, which a diffusion profile's albedo is that of.
#[test]
fn thin_slabs() {
    let (width, height) = (2, 512);
    let radiance =
        (0..width * height).map(|i| Rgb::splat(f32::from(u8::from(i / width < height / 2)))).collect();
    let above = Environment::Map { width, height, radiance, rotation: Mat3::IDENTITY };
    let table = rows("slab_planar_RT.csv");
    let mut figures = Vec::new();
    for (mode, tau, omegas) in [
        (ColorMode::Rgb, 2.0, [0.99, 0.9999, 0.9]),
        (ColorMode::Rgb, 1.0, [0.99, 0.9999, 0.99]),
        (ColorMode::Spectral, 2.0, [0.99; 3]),
        (ColorMode::Spectral, 2.0, [0.9999; 3]),
        (ColorMode::Spectral, 1.0, [0.9999; 3]),
    ] {
        let albedo = Rgb::from_fn(|c| omegas[c] as f32);
        let material = translucent(1.0, (Rgb::ONE - albedo) * tau as f32, albedo * tau as f32, 0.0);
        let scene = Scene { environment: Some(above.clone()), ..slab(material) };
        // By wavelength a quarter of them.
        let paths = if mode == ColorMode::Spectral { 400_000 } else { 200_000 };
        for (setup, found) in renderings_in(mode, &scene, by(Method::Walk), &Rays(paths, down)) {
            for (channel, omega) in found.parts(mode).iter().zip(omegas).take(2) {
                let is_asked =
                    |row: &&Vec<String>| [0, 1, 2, 3].map(|i| number(&row[i])) == [tau, omega, 0.0, 1.0];
                let exact = table.iter().find(is_asked).map(|row| number(&row[4])).unwrap();
                let (mean, sigma) = (channel.mean(), channel.standard_error());
                let holds = |r: f64| (r - exact).abs() < 3.0 * sigma;
                assert!(holds(mean), "τ {tau} ω {omega} {setup}: {mean} ± {sigma}, exactly {exact}");
                assert!(sigma < 2e-3);
                let half_space =
                    PlaneParallel::new(1.0, 0.0).half_space(1.0 - omega).reflectance(Entry::Normal);
                assert_fails("the albedo of a half-space", half_space, holds);
                if let Some(mode) = setup.recorded() {
                    figures.push(format!(
                        "{mode} τ {tau} ω {omega}: {:+.1} ± {:.1} ‰, half-space ×{:.2}",
                        1e3 * (mean / exact - 1.0),
                        1e3 * sigma / exact,
                        half_space / exact
                    ));
                }
            }
        }
    }
    record("thin_slabs", figures.join("; "));
}

/// Albedos of 0 and 1 side by side on one surface, where coefficients are found by inversion.
#[test]
fn black_and_white_texels() {
    let colors = |mesh: &Mesh| -> Vec<Vec4> {
        let color = |i: usize| if i.is_multiple_of(3) { Vec4::new(0.0, 1.0, 1e-7, 1.0) } else { Vec4::ONE };
        (0..mesh.positions.len()).map(color).collect()
    };
    let sphere = shape::sphere(Vec3::ZERO, 1.0, 4);
    let mesh = Mesh { colors: colors(&sphere), ..sphere };
    let albedo = ColorInput { factor: Rgb::ONE, texture: None, vertex_color: true };
    let mut figure = Figures::default();
    for ior in [1.0, 1.4] {
        let medium = ScatteringInput::Albedo { albedo, mean_free_path: Rgb::new(0.1, 0.2, 0.05), g: 0.3 };
        let material = Material {
            surface: Surface::Translucent { ior, roughness: 0.0, medium },
            ..white(ior, 0.0, Rgb::ONE)
        };
        let scene = furnace(mesh.clone(), material);
        for method in [Method::Diffuse, Method::Bssrdf, Method::Walk] {
            for (setup, found) in renderings(&scene, by(method), &Pictures(16)) {
                assert_eq!(found.counters.rejected, 0);
                let mixed = match setup.mode {
                    ColorMode::Spectral => &found.mean,
                    _ => &found.radiance[0],
                };
                assert!(mixed.mean() < 1.0 && mixed.mean() > 0.0, "{method:?} {setup}: {}", mixed.mean());
                figure.keep(setup, format!("mixed {:.3}", mixed.mean()));
                if setup.mode == ColorMode::Rgb {
                    let (mean, sigma) = (found.radiance[1].mean(), found.radiance[1].standard_error());
                    assert!((mean - 1.0).abs() < 4.0 * sigma + 1e-4, "{method:?} {setup}: {mean} ± {sigma}");
                    figure.keep(
                        setup,
                        format!("white channel {mean:.5} ± {sigma:.5}, mixed one {:.3}", mixed.mean()),
                    );
                }
            }
        }
    }
    record("black_and_white_texels", figure.written());
}
