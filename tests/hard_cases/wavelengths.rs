//! Light by wavelength at its ends: saturated colours, wavelengths that have next to nothing in common, lamps that are nearly red or nearly violet.

use std::f64::consts::PI;
use std::sync::Arc;

use alabaster::math::sampler::HashGenerator;
use alabaster::optics::fresnel_dielectric;
use alabaster::radiometry::Rgb;
use alabaster::radiometry::color::{RGB_TO_XYZ, XYZ_TO_RGB};
use alabaster::radiometry::spectrum::dispersion::Dispersion;
use alabaster::radiometry::spectrum::lamp::Lamp;
use alabaster::radiometry::spectrum::medium_table::MediumTable;
use alabaster::radiometry::spectrum::observer::{LUMINANCE_INTEGRAL, color_matching, xyz};
use alabaster::radiometry::spectrum::upsampling::{BoundedSpectrum, daylight};
use alabaster::scene::{
    Camera, ColorInput, ColorMode, Emitted, Light, Material, Method, ScalarInput, ScatteringInput, Scene,
    Surface, shape,
};
use alabaster::transport::{Counters, RenderOptions, Renderer};
use glam::{DVec3, Vec3};

use crate::common::backends::{Pictures, Rays, by, renderings_in};
use crate::common::scenes::{Statistics, caster, furnace, options, white};
use crate::media::largest_weight_by_one_channel;
use crate::record::{Figures, assert_fails, record};

/// Channels exactly 0 and exactly 1.
const PRIMARIES: [[f32; 3]; 6] =
    [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 1.0, 0.0], [0.0, 1.0, 1.0], [1.0, 0.0, 1.0]];

fn diffuse(reflectance: Rgb) -> Material {
    let surface = Surface::Diffuse { reflectance: ColorInput::constant(reflectance) };
    Material { surface, ..white(1.0, 0.0, Rgb::ONE) }
}

#[test]
fn single_samples_out_of_gamut() {
    let sphere = |material: Material| furnace(shape::sphere(Vec3::ZERO, 1.0, 4), material);
    // Green: most of what it reflects has a red below 0.
    let albedo = Rgb::new(0.0, 1.0, 0.0);
    let mut scene = sphere(diffuse(albedo));
    scene.render.color_mode = ColorMode::Spectral;
    let renderer = Renderer::new(scene, options(), caster).unwrap();
    let (mut channels, mut clipped): ([Statistics; 3], [Statistics; 3]) = Default::default();
    // Rays against the sphere alone.
    for sample in 0..20_000 {
        let radiance = renderer.radiance(Vec3::Y * 3.0, Vec3::NEG_Y, sample, &mut Counters::default());
        for c in 0..3 {
            channels[c].add(radiance[c].into());
            clipped[c].add(radiance[c].max(0.0).into());
        }
    }
    let share = BoundedSpectrum::fit(albedo).unwrap();
    let reflected = |nanometres: f64| f64::from(share.value(nanometres as f32) * daylight(nanometres as f32));
    let exact = *XYZ_TO_RGB * DVec3::from(xyz(reflected));
    // Three channels: 4σ; and a thousandth for the bends of the product between rows of 5 nm.
    let holds = |channels: &[Statistics; 3]| {
        let off =
            |c: usize| (channels[c].mean() - exact[c]).abs() / (4.0 * channels[c].standard_error() + 1e-3);
        (0..3).all(|c| off(c) < 1.0)
    };
    let means = |channels: &[Statistics; 3]| channels.each_ref().map(Statistics::mean);
    assert!(holds(&channels), "{:?} {exact}", means(&channels));
    assert_fails("samples clipped at 0", &clipped, holds);

    let mut brightest = 0.0_f64;
    for primary in PRIMARIES {
        let albedo = ColorInput::constant(Rgb::from_fn(|c| primary[c]));
        let medium = ScatteringInput::Albedo { albedo, mean_free_path: Rgb::new(0.1, 0.3, 0.05), g: 0.3 };
        let body = Surface::Translucent { ior: 1.4, roughness: 0.0, medium };
        for (material, method) in [
            (diffuse(albedo.factor), Method::Bssrdf),
            (Material { surface: body.clone(), ..diffuse(Rgb::ONE) }, Method::Bssrdf),
            (Material { surface: body, ..diffuse(Rgb::ONE) }, Method::Walk),
        ] {
            for (setup, found) in
                renderings_in(ColorMode::Spectral, &sphere(material), by(method), &Pictures(32))
            {
                let (mean, sigma) = (found.mean.mean(), found.mean.standard_error());
                let what = format!("{primary:?} {method:?} {setup}: {mean} ± {sigma}");
                assert!(mean > 0.0 && mean < 1.0 + 3.0 * sigma, "{what}");
                assert_eq!((found.counters.rejected, found.counters.capped_paths), (0, 0), "{what}");
                let value = |wanted: f32| {
                    let of = move |(c, channel): (usize, &Statistics)| {
                        (primary[c] == wanted).then(|| channel.mean())
                    };
                    found.radiance.iter().enumerate().filter_map(of)
                };
                assert!(value(1.0).fold(f64::MAX, f64::min) > value(0.0).fold(f64::MIN, f64::max), "{what}");
                brightest = brightest.max(mean);
            }
        }
    }
    let [red, green, blue] = means(&channels);
    let [clipped_red, clipped_green, clipped_blue] = means(&clipped);
    record(
        "single_samples_out_of_gamut",
        format!(
            "green {red:.3}, {green:.3}, {blue:.3}; clipped {clipped_red:.3}, {clipped_green:.3}, {clipped_blue:.3}; \
             of the primaries at most {brightest:.2}"
        ),
    );
}

#[test]
fn unequal_wavelengths() {
    let (mut farthest, mut most) = (0.0_f64, 0.0_f64);
    // mm⁻¹. What channels are given by is smoothed on its way to wavelengths: the ratio needs a table.
    let tables = [
        ("red", "360,1e-5\n575,1e-5\n580,0.1\n830,0.1"),
        ("blue", "360,0.1\n500,0.1\n505,1e-5\n830,1e-5"),
        ("green", "360,1e-5\n530,1e-5\n535,0.1\n565,0.1\n570,1e-5\n830,1e-5"),
        ("magenta", "360,0.1\n530,0.1\n535,1e-5\n565,1e-5\n570,0.1\n830,0.1"),
    ];
    for (name, rows) in tables {
        let rows = rows.replace(',', ",0,");
        let table = MediumTable::parse(&format!("wavelength,mu_a,mu_s\n{rows}\n")).unwrap();
        let medium = ScatteringInput::Spectral {
            sigma_a: Rgb::ZERO,
            sigma_s: Rgb::splat(50.0),
            g: 0.0,
            table: Arc::new(table),
        };
        let surface = Surface::Translucent { ior: 1.4, roughness: 0.0, medium };
        let material = Material { surface, ..diffuse(Rgb::ONE) };
        let scene = furnace(shape::sphere(Vec3::ZERO, 1.0, 4), material);
        for method in [Method::Walk, Method::Bssrdf] {
            let options = RenderOptions { guiding: false, ..by(method) };
            for (setup, found) in renderings_in(ColorMode::Spectral, &scene, options, &Pictures(16)) {
                let (mean, sigma) = (found.mean.mean(), found.mean.standard_error());
                let what = format!("{name} {method:?} {setup}: {mean} ± {sigma}");
                assert!((mean - 1.0).abs() < 3.0 * sigma + 1e-5, "{what}");
                assert_eq!((found.counters.rejected, found.counters.capped_paths), (0, 0), "{what}");
                farthest = farthest.max((mean - 1.0).abs());
                if method == Method::Walk {
                    most = most.max(found.mean.max);
                }
            }
        }
    }
    // What four wavelengths carry together never grows; some hundred roundings.
    let holds = |weight: f64| weight <= 4.0 * (1.0 + 1e-5);
    assert!(holds(most), "{most}");
    let naive = largest_weight_by_one_channel(Rgb::new(0.01, 100.0, 100.0));
    assert_fails("flights by one wavelength alone", naive, holds);
    record(
        "unequal_wavelengths",
        format!("furnace {farthest:.0e}; largest sample {most:.3}, by one wavelength alone {naive:.0e}"),
    );
}

/// A body in which light of a single row of the tables is not absorbed at the first collision.
#[test]
fn one_wavelength_of_light() {
    const LINE: f64 = 550.0;
    // mm⁻¹: 10⁶/m.
    let table = "wavelength,mu_a,mu_s\n360,1000,1\n545,1000,1\n550,0,1\n555,1000,1\n830,1000,1\n";
    let medium = |sigma_a: Rgb| ScatteringInput::Spectral {
        sigma_a,
        sigma_s: Rgb::splat(1e3),
        g: 0.0,
        table: Arc::new(MediumTable::parse(table).unwrap()),
    };
    let surface = Surface::Translucent { ior: 1.0, roughness: 0.0, medium: medium(Rgb::splat(1e6)) };
    let material = Material { surface, ..white(1.0, 0.0, Rgb::ONE) };
    let scene = furnace(shape::sphere(Vec3::ZERO, 0.01, 4), material);
    let through = |sample: u64| {
        let mut random = HashGenerator::new(sample);
        let [x, y] = [(); 2].map(|()| 0.01 * (random.next_f32() - 0.5));
        (Vec3::new(x, y, 1.0), Vec3::NEG_Z)
    };
    // Rows stand for what is linear between them: the line is a triangle 10 nm wide.
    let steps = 10_000;
    let luminance = |i: i32| {
        let off = 5.0 * f64::from(2 * i - steps) / f64::from(steps);
        (1.0 - off.abs() / 5.0) * color_matching(LINE + off)[1] * 10.0 / f64::from(steps)
    };
    let exact =
        (0..steps).map(luminance).sum::<f64>() * f64::from(daylight(LINE as f32)) / LUMINANCE_INTEGRAL;
    let mut figures = Figures::default();
    let all = |mode| renderings_in(mode, &scene, by(Method::Walk), &Rays(800_000, through));
    for (setup, found) in all(ColorMode::Spectral) {
        let (mean, sigma) = (found.mean.mean(), found.mean.standard_error());
        // Of the rest a thousandth is scattered at the surface, half of it back.
        let holds = |mean: f64| (mean - exact).abs() < 3.0 * sigma + 5e-4;
        println!("{setup}: {mean} ± {sigma}, {exact}");
        assert!(holds(mean), "{setup}: {mean} ± {sigma}, {exact}");
        assert_eq!((found.counters.rejected, found.counters.capped_paths), (0, 0), "{setup}");
        for (_, channels) in all(ColorMode::Rgb) {
            assert_fails("red, green and blue", channels.mean.mean(), holds);
        }
        figures.keep(setup, format!("{mean:.4} ± {sigma:.4} of {exact:.4}"));
    }
    record("one_wavelength_of_light", figures.written());
}

#[test]
fn glass_of_abbe_number_one() {
    let dispersion = Dispersion::from_abbe(1.5, 1.0).unwrap();
    let sphere = shape::sphere(Vec3::ZERO, 1.0, 4);
    let block = shape::cuboid(Vec3::ZERO, Vec3::new(1.0, 0.7, 1.2));
    let (mut farthest, mut most) = (0.0_f64, 0.0_f64);
    for roughness in [0.0, 0.4] {
        let surface = Surface::Dielectric {
            ior: 1.5,
            dispersion: Some(dispersion),
            roughness: ScalarInput::constant(roughness),
            sigma_a: Rgb::ZERO,
            tint: ColorInput::constant(Rgb::ONE),
        };
        for mesh in [&sphere, &block] {
            let scene = furnace(mesh.clone(), Material { surface: surface.clone(), ..diffuse(Rgb::ONE) });
            for (setup, found) in
                renderings_in(ColorMode::Spectral, &scene, by(Method::Bssrdf), &Pictures(256))
            {
                let (mean, sigma) = (found.mean.mean(), found.mean.standard_error());
                println!("roughness {roughness} {setup}: {mean} ± {sigma}, {}", found.mean.max);
                assert!(mean < 1.0 + 3.0 * sigma + 1e-5, "{setup}: {mean} ± {sigma}");
                assert_eq!(found.counters.rejected, 0, "{setup}");
                // Rough ones lose what meets their facets twice.
                if roughness == 0.0 {
                    assert!(mean > 1.0 - 3.0 * sigma - 1e-5, "{setup}: {mean} ± {sigma}");
                    farthest = farthest.max((mean - 1.0).abs());
                }
                most = most.max(found.mean.max);
            }
        }
    }
    // 1 − R ≤ Σ(1 − R) = 4(1 − mean): the first wavelength weighs at most four times what four together do.
    let holds = |weight: f64| weight <= 16.0;
    assert!(holds(most), "{most}");
    // What another wavelength gains where the first is reflected, straight down.
    let reflectance =
        |nanometres: f64| f64::from(fresnel_dielectric(1.0, dispersion.ior(nanometres) as f32).reflectance);
    let naive = reflectance(360.0) / reflectance(830.0);
    assert_fails("all carried along", naive, holds);
    record(
        "glass_of_abbe_number_one",
        format!("furnace {farthest:.0e}; largest sample {most:.2}, carried along {naive:.0}"),
    );
}

#[test]
fn lamps_of_extreme_temperature() {
    const SAMPLES: u64 = 400_000;
    let mut figures = Vec::new();
    for kelvin in [1000.0, 40_000.0] {
        let lamp = Lamp::blackbody(kelvin).unwrap();
        let irradiance = Emitted::by(lamp, 1.0);
        let mut scene = Scene {
            camera: Camera::default(),
            environment: None,
            lights: vec![Light::Directional { direction: Vec3::NEG_Y, irradiance }],
            ..furnace(shape::quad(Vec3::ZERO, Vec3::Z, Vec3::X), diffuse(Rgb::ONE))
        };
        scene.render.color_mode = ColorMode::Spectral;
        let renderer = Renderer::new(scene, options(), caster).unwrap();
        let mut found: [Statistics; 3] = Default::default();
        for sample in 0..SAMPLES {
            let radiance =
                renderer.radiance(Vec3::new(0.3, 1.0, 0.1), Vec3::NEG_Y, sample, &mut Counters::default());
            assert!(radiance.is_finite());
            let brought = *RGB_TO_XYZ * DVec3::from(radiance.0.map(|x| f64::from(x) * PI));
            found.iter_mut().zip(brought.to_array()).for_each(|(all, x)| all.add(x));
        }
        let exact = xyz(|nanometres| lamp.relative_power(nanometres));
        // A line between rows of 5 nm lies above what bends up: by (5 nm)²/12 times the second derivative, at 1000 K and 560 nm 3 ‰.
        let holds = |mean: [f64; 3]| {
            let allowed = |c: usize| 3.0 * found[c].standard_error() + 4e-3 * exact[c];
            (0..3).all(|c| (mean[c] - exact[c]).abs() < allowed(c))
        };
        let mean = found.each_ref().map(Statistics::mean);
        println!("{kelvin} K: {mean:?} {exact:?} ± {:?}", found.each_ref().map(Statistics::standard_error));
        assert!(holds(mean), "{kelvin} K: {mean:?} {exact:?}");
        let shown = (*RGB_TO_XYZ * DVec3::from(irradiance.rgb.0.map(f64::from))).to_array();
        if kelvin < 1900.0 {
            assert_fails("the lamp as red, green and blue", shown, holds);
        }
        let [off, naive] = [mean, shown]
            .map(|color| 100.0 * (0..3).map(|c| (color[c] / exact[c] - 1.0).abs()).fold(0.0, f64::max));
        figures.push(format!("{kelvin} K: {off:.1} %, as red, green and blue {naive:.0} %"));
    }
    record("lamps_of_extreme_temperature", figures.join("; "));
}
