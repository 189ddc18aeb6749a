//! Light by wavelength: the same picture as by red, green and blue where nothing depends on the wavelength, no light made or lost where something
//! does, and each wavelength where Snell's law sends it.

mod common;

use alabaster::math::sampler::HashGenerator;
use alabaster::optics::{Bsdf, Dielectric, fresnel_dielectric};
use alabaster::plan::Kernel;
use alabaster::radiometry::color::RGB_TO_XYZ;
use alabaster::radiometry::spectrum::dispersion::{Dispersion, FRAUNHOFER_LINES};
use alabaster::radiometry::spectrum::illuminant::Illuminant;
use alabaster::radiometry::spectrum::lamp::Lamp;
use alabaster::radiometry::spectrum::observer::{LUMINANCE_INTEGRAL, chromaticity, color_matching};
use alabaster::radiometry::{Rgb, Spectrum};

use alabaster::scene::{
    ColorInput, ColorMode, Emitted, Light, Material, Mesh, Method, ScalarInput, ScatteringInput, Scene,
    Surface, shape,
};
use alabaster::transport::{Counters, RenderOptions, Renderer};
use common::scenes::{Caster, Statistics, caster, furnace, options, white};
use glam::{DVec2, DVec3, Vec3};

/// A dense flint glass (Schott N-SF11, catalogue values).
fn flint() -> Dispersion {
    let b = [1.737_596_95, 0.313_747_346, 1.898_781_01];
    Dispersion::sellmeier(b, [0.013_188_707, 0.062_306_814_2, 155.236_29]).unwrap()
}

fn glass(dispersion: Option<Dispersion>, ior: f32, roughness: f32) -> Material {
    let surface = Surface::Dielectric {
        ior,
        dispersion,
        roughness: ScalarInput::constant(roughness),
        sigma_a: Rgb::ZERO,
        tint: ColorInput::constant(Rgb::ONE),
    };
    Material { surface, emission: ColorInput::constant(Rgb::ZERO), ..Material::default() }
}

fn rendered(mut scene: Scene, mode: ColorMode, method: Method) -> Renderer<Caster> {
    scene.render.color_mode = mode;
    Renderer::new(scene, RenderOptions { method, ..options() }, caster).unwrap()
}

/// Statistics of the channels over `samples` samples of all pixels, and of their luminance.
fn measured(renderer: &Renderer<Caster>, samples: u64) -> [Statistics; 4] {
    let film = renderer.scene().film;
    let mut all: [Statistics; 4] = Default::default();
    for (x, y) in (0..film.height).flat_map(|y| (0..film.width).map(move |x| (x, y))) {
        for sample in 0..samples {
            let radiance = renderer.sample(x, y, sample, &mut Counters::default());
            assert!(radiance.is_finite(), "not finite at ({x}, {y})");
            let xyz = *RGB_TO_XYZ * DVec3::from(radiance.0.map(f64::from));
            all.iter_mut().zip([0, 1, 2]).for_each(|(channel, c)| channel.add(f64::from(radiance[c])));
            all[3].add(xyz.y);
        }
    }
    all
}

/// Grey bodies of every kind, in white light from everywhere and from a lamp.
fn neutral() -> Vec<(&'static str, Scene, Method)> {
    let grey =
        |surface| Material { surface, emission: ColorInput::constant(Rgb::ZERO), ..Material::default() };
    let half = ColorInput::constant(Rgb::splat(0.5));
    let diffuse = grey(Surface::Diffuse { reflectance: half });
    let metal = grey(Surface::Metal { reflectance: half, roughness: ScalarInput::constant(0.4) });
    let coefficients =
        ScatteringInput::Coefficients { sigma_a: Rgb::splat(0.3), sigma_s: Rgb::splat(8.0), g: 0.0 };
    let albedo = ScatteringInput::Albedo { albedo: half, mean_free_path: Rgb::splat(0.1), g: 0.3 };
    let translucent = |medium| grey(Surface::Translucent { ior: 1.4, roughness: 0.3, medium });
    let bodies = [
        ("diffuse", diffuse, Method::Bssrdf),
        ("metal", metal, Method::Bssrdf),
        ("glass", glass(None, 1.5, 0.0), Method::Bssrdf),
        ("rough glass", glass(None, 1.5, 0.4), Method::Bssrdf),
        ("area integral", translucent(coefficients.clone()), Method::Bssrdf),
        ("area integral by albedo", translucent(albedo.clone()), Method::Bssrdf),
        ("walk", translucent(coefficients), Method::Walk),
        ("walk by albedo", translucent(albedo), Method::Walk),
    ];
    let lamp =
        Light::Sphere { center: Vec3::new(3.0, 4.0, 1.0), radius: 0.5, radiance: Rgb::splat(20.0).into() };
    bodies
        .into_iter()
        .map(|(name, material, method)| {
            let scene = furnace(shape::sphere(Vec3::ZERO, 1.0, 4), material);
            (name, Scene { lights: vec![lamp.clone()], ..scene }, method)
        })
        .collect()
}

#[test]
fn neutral_scenes_are_the_same_by_wavelength() {
    for (name, scene, method) in neutral() {
        let by_color = measured(&rendered(scene.clone(), ColorMode::Rgb, method), 24);
        let spectral = rendered(scene, ColorMode::Spectral, method);
        assert_eq!(spectral.kernel(), Kernel::Spectral);
        let by_wavelength = measured(&spectral, 24);
        for (c, (a, b)) in by_color.iter().zip(&by_wavelength).enumerate() {
            let sigma = a.standard_error().hypot(b.standard_error());
            println!("{name}, {c}: {:.5} {:.5} ± {sigma:.5}", a.mean(), b.mean());
            // Pixels of one picture differ, so that σ is more than that of its noise.
            assert!(
                (a.mean() - b.mean()).abs() < 3.0 * sigma,
                "{name}, {c}: {} {} ± {sigma}",
                a.mean(),
                b.mean()
            );
        }
    }
}

/// Uniform light stays uniform at each wavelength, however differently they are scattered or bent.
#[test]
fn nothing_is_made_or_lost() {
    let colored = Rgb::new(4.0, 10.0, 25.0);
    let bodies = [
        ("area integral", white(1.4, 0.3, colored), Method::Bssrdf),
        ("walk", white(1.4, 0.3, colored), Method::Walk),
        ("walk, index 1", white(1.0, 0.0, colored), Method::Walk),
        ("flint", glass(Some(flint()), 1.785, 0.0), Method::Bssrdf),
    ];
    for (name, material, method) in bodies {
        let scene = furnace(shape::sphere(Vec3::ZERO, 1.0, 4), material);
        let [.., luminance] = measured(&rendered(scene, ColorMode::Spectral, method), 32);
        let (mean, sigma) = (luminance.mean(), luminance.standard_error());
        println!("{name}: {mean:.5} ± {sigma:.5}");
        // Rounding of products along a path of some hundred factors leaves a few 1e-6.
        assert!((mean - 1.0).abs() < 3.0 * sigma + 1e-5, "{name}: {mean} ± {sigma}");
        assert!(sigma < 0.01, "{name}: too noisy to tell");
    }
}

/// Glass that disperses next to nothing looks like glass that does not, smooth and rough: what a path does where
/// wavelengths part leaves no bias.
#[test]
fn parting_of_wavelengths_leaves_no_bias() {
    let weak = Dispersion::cauchy([1.5, 1e-3, 0.0]).unwrap();
    for roughness in [0.0, 0.4] {
        let picture = |dispersion| {
            let mut scene = furnace(shape::sphere(Vec3::ZERO, 1.0, 4), glass(dispersion, 1.5, roughness));
            let radiance = Rgb::splat(30.0).into();
            scene.lights.push(Light::Sphere { center: Vec3::new(0.0, 3.0, -2.0), radius: 1.0, radiance });
            measured(&rendered(scene, ColorMode::Spectral, Method::Bssrdf), 48)
        };
        for (a, b) in picture(None).iter().zip(&picture(Some(weak))) {
            let sigma = a.standard_error().hypot(b.standard_error());
            println!("{roughness}: {:.5} {:.5} ± {sigma:.5}", a.mean(), b.mean());
            assert!((a.mean() - b.mean()).abs() < 3.0 * sigma, "{} {} ± {sigma}", a.mean(), b.mean());
        }
    }
}

/// sin θ_i = n(λ) sin θ_t at the three lines that an Abbe number is of.
#[test]
fn refraction_is_snells_at_each_wavelength() {
    for nanometres in FRAUNHOFER_LINES {
        let n = flint().ior(nanometres);
        let bsdf = Bsdf::Dielectric(Dielectric { eta: n as f32, alpha: 0.0, tint: Spectrum([1.0]) });
        for degrees in [10.0_f64, 30.0, 60.0, 85.0] {
            let (sin, cos) = degrees.to_radians().sin_cos();
            // The largest number of a lobe: never reflected.
            let sample =
                bsdf.sample(Vec3::new(sin as f32, 0.0, cos as f32), [0.5, 0.5, 1.0 - f32::EPSILON]).unwrap();
            let angle = f64::from(-sample.direction.x).atan2(f64::from(-sample.direction.z));
            let expected = (sin / n).asin();
            assert!((angle - expected).abs() < 1e-5, "{nanometres} nm, {degrees}°: {angle} {expected}");
        }
    }
}

/// Light of one wavelength through the prism, in its plane of dispersion.
struct Ray {
    origin: DVec2,
    direction: DVec2,
    /// Share that was not reflected at either face.
    transmitted: f64,
}

/// Corners of a prism of 60°, 2 high, in the plane x, y.
const APEX: DVec2 = DVec2::new(0.0, 1.0);
const LEFT: DVec2 = DVec2::new(-1.154_700_538_379_251_7, -1.0);
const RIGHT: DVec2 = DVec2::new(1.154_700_538_379_251_7, -1.0);

fn prism() -> Mesh {
    let corner = |p: DVec2, z: f32| Vec3::new(p.x as f32, p.y as f32, z);
    let positions = [-2.0, 2.0].into_iter().flat_map(|z| [APEX, LEFT, RIGHT].map(|p| corner(p, z))).collect();
    let triangles =
        vec![[0, 2, 1], [3, 4, 5], [0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4], [2, 0, 3], [2, 3, 5]];
    Mesh { positions, triangles, ..Mesh::default() }
}

/// Refracts at a face of unit `normal`, against which `direction` goes, from index 1/`eta` to 1 relative.
fn refracted(direction: DVec2, normal: DVec2, eta: f64) -> DVec2 {
    let cos = -direction.dot(normal);
    let along = (direction + normal * cos) / eta;
    along - normal * (1.0 - along.length_squared()).sqrt()
}

/// From `from` through the left face, and the right one.
fn through(from: DVec2, direction: DVec2, n: f64) -> Ray {
    let normal = |a: DVec2, b: DVec2| (b - a).normalize().perp();
    let meets = |origin: DVec2, direction: DVec2, a: DVec2, normal: DVec2| {
        origin + direction * ((a - origin).dot(normal) / direction.dot(normal))
    };
    let (left, right) = (normal(LEFT, APEX), normal(APEX, RIGHT));
    let entry = meets(from, direction, LEFT, left);
    let inside = refracted(direction, left, n);
    let exit = meets(entry, inside, RIGHT, right);
    let outside = refracted(inside, -right, 1.0 / n);
    let passed = |cos: f64| f64::from(fresnel_dielectric(cos as f32, n as f32).transmittance);
    let transmitted = passed(-direction.dot(left)) * passed(-inside.dot(right));
    Ray { origin: exit, direction: outside, transmitted }
}

/// A small far lamp behind a prism is seen in the colour of the wavelengths that Snell's law takes to it, as bright as the
/// prism leaves it.
#[test]
fn a_prism_shows_each_wavelength_in_its_place() {
    const DISTANCE: f64 = 1000.0;
    const RADIUS: f64 = 1.0;
    const SAMPLES: u64 = 300_000;
    for nanometres in [470.0, 530.0, 600.0] {
        let n = flint().ior(nanometres);
        // Some degrees off least deviation: there light that was reflected by the base, which is not dispersed, would come out towards the lamp, too.
        let (sin, cos) = ((n * 0.5).asin() - 22_f64.to_radians()).sin_cos();
        let direction = DVec2::new(cos, sin);
        let from = DVec2::new(-3.0, -3.0 * sin / cos + 0.2);
        let towards = through(from, direction, n);
        let lamp = towards.origin + towards.direction * DISTANCE;
        let seen = |nanometres: f64| {
            let ray = through(from, direction, flint().ior(nanometres));
            let miss = (lamp - ray.origin).perp_dot(ray.direction).abs();
            if miss < RADIUS { ray.transmitted } else { 0.0 }
        };
        let mut expected = DVec3::ZERO;
        let step = 0.002;
        for i in -10_000..=10_000 {
            let at = nanometres + step * f64::from(i);
            expected += DVec3::from(color_matching(at)) * (seen(at) * step / LUMINANCE_INTEGRAL);
        }
        let scene = Scene {
            environment: None,
            lights: vec![Light::Sphere {
                center: Vec3::new(lamp.x as f32, lamp.y as f32, 0.0),
                radius: RADIUS as f32,
                radiance: Emitted::by(Lamp::illuminant("E").unwrap(), 1.0),
            }],
            ..furnace(prism(), glass(Some(flint()), 1.785, 0.0))
        };
        let renderer = rendered(scene, ColorMode::Auto, Method::Bssrdf);
        assert_eq!(renderer.kernel(), Kernel::Spectral, "dispersion calls for it");
        let mut xyz: [Statistics; 3] = Default::default();
        let (origin, direction) = (from.extend(0.0).as_vec3(), direction.extend(0.0).as_vec3());
        for sample in 0..SAMPLES {
            let radiance = renderer.radiance(origin, direction, sample, &mut Counters::default());
            let brought = *RGB_TO_XYZ * DVec3::from(radiance.0.map(f64::from));
            xyz.iter_mut().zip(brought.to_array()).for_each(|(component, x)| component.add(x));
        }
        let mean = DVec3::from(xyz.each_ref().map(Statistics::mean));
        println!("{nanometres} nm: {mean} {expected}, {:?}", chromaticity(mean.to_array()));
        for (c, component) in xyz.iter().enumerate() {
            let sigma = component.standard_error();
            // Single precision of positions a thousand away moves the band by a thousandth of its width.
            let allowed = 3.0 * sigma + 2e-3 * expected[c];
            assert!((mean[c] - expected[c]).abs() < allowed, "{nanometres} nm: {mean} {expected} ± {sigma}");
        }
        let [a, b] = [mean.to_array(), color_matching(nanometres)].map(chromaticity);
        assert!((a[0] - b[0]).hypot(a[1] - b[1]) < 0.02, "{nanometres} nm: {a:?} {b:?}");
    }
}

/// A white surface shows the colour of the lamp.
#[test]
fn white_under_a_lamp_has_its_color() {
    let reflectance = ColorInput::constant(Rgb::splat(0.8));
    let material = Material {
        surface: Surface::Diffuse { reflectance },
        emission: ColorInput::constant(Rgb::ZERO),
        ..Material::default()
    };
    for name in ["A", "E", "D50"] {
        let irradiance = Emitted::by(Lamp::illuminant(name).unwrap(), 2.0);
        let scene = Scene {
            environment: None,
            lights: vec![Light::Directional { direction: Vec3::NEG_Y, irradiance }],
            ..furnace(shape::quad(Vec3::ZERO, Vec3::Z * 5.0, Vec3::X * 5.0), material.clone())
        };
        let renderer = rendered(scene, ColorMode::Auto, Method::Bssrdf);
        assert_eq!(renderer.kernel(), Kernel::Spectral);
        let mut random = HashGenerator::new(5);
        let mut sums: [Statistics; 3] = Default::default();
        for sample in 0..40_000 {
            let origin = Vec3::new(random.next_f32(), 2.0, random.next_f32());
            let radiance = renderer.radiance(origin, Vec3::NEG_Y, sample, &mut Counters::default());
            let xyz = *RGB_TO_XYZ * DVec3::from(radiance.0.map(f64::from));
            sums.iter_mut().zip(xyz.to_array()).for_each(|(sum, x)| sum.add(x));
        }
        let white = Illuminant::from_name(name).unwrap().white();
        // Irradiance 2, reflectance 0.8.
        let level = 2.0 * 0.8 / std::f64::consts::PI;
        for (sum, white) in sums.iter().zip(white) {
            let (mean, sigma) = (sum.mean(), sum.standard_error());
            // Rows of 5 nm between which A and D50 are linear to 1e-4.
            assert!(
                (mean - level * white).abs() < 3.0 * sigma + 2e-4,
                "{name}: {mean} {} ± {sigma}",
                level * white
            );
        }
    }
}
