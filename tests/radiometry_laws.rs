//! The laws of radiometry, measured by rendering.

mod common;

use std::f64::consts::PI;

use alabaster::math::sampler::HashGenerator;
use alabaster::radiometry::{
    Irradiance, ProjectedSolidAngle, Radiance, RadiantFlux, RadiantIntensity, Rgb, SolidAngle,
};
use alabaster::scene::{Camera, ColorInput, ColorMode, Instance, Light, Material, Scene, Surface, shape};
use alabaster::study::laws::neumann_orders;
use alabaster::transport::{Counters, RenderOptions, Renderer, Unbalanced};
use common::scenes::{Caster, Statistics, body, caster, furnace, options, renderer};
use glam::{Affine3A, DVec3, Vec3};

/// Reflectance of everything that serves to measure irradiance.
const REFLECTANCE: f64 = 0.5;

fn diffuse() -> Material {
    let reflectance = ColorInput::constant(Rgb::splat(REFLECTANCE as f32));
    Material {
        surface: Surface::Diffuse { reflectance },
        emission: ColorInput::constant(Rgb::ZERO),
        ..Material::default()
    }
}

/// `mesh` of diffuse reflectance, under `lights` alone.
fn lit(mesh: alabaster::scene::Mesh, lights: Vec<Light>) -> Scene {
    Scene { environment: None, lights, ..furnace(mesh, diffuse()) }
}

/// Light that was scattered once only.
fn scattered_once(scene: Scene) -> Renderer<Caster> {
    Renderer::new(scene, RenderOptions { max_depth: 1, ..options() }, caster).unwrap()
}

/// Irradiance of what is seen from `origin` in `direction`: E = π L/ϱ of Lambert's surface.
fn irradiance(renderer: &Renderer<Caster>, origin: Vec3, direction: Vec3, samples: u64) -> Statistics {
    let mut statistics = Statistics::default();
    for sample in 0..samples {
        let radiance = renderer.radiance(origin, direction, sample, &mut Counters::default());
        statistics.add(f64::from(radiance[1]) * PI / REFLECTANCE);
    }
    statistics
}

/// E = Φ/(4πr²) on the sphere of radius r around a point that sends out the power Φ.
#[test]
fn a_point_light_fills_every_sphere_around_it() {
    for radius in [0.25_f32, 1.0, 40.0] {
        let light = Light::Point { position: Vec3::ZERO, intensity: Rgb::splat(3.0).into() };
        let RadiantFlux(power) = light.power().unwrap();
        let expected: Irradiance =
            (RadiantFlux(f64::from(power[1])) / SolidAngle::SPHERE).irradiance(f64::from(radius), 1.0);
        let mut mesh = shape::sphere(Vec3::ZERO, radius, 6);
        mesh.normals.clear();
        let renderer = scattered_once(lit(mesh, vec![light]));
        let mut random = HashGenerator::new(1);
        let mut sphere = Statistics::default();
        for _ in 0..500 {
            let direction = Vec3::from_array([0; 3].map(|_| random.next_f32() - 0.5)).normalize();
            let measured = irradiance(&renderer, Vec3::ZERO, direction, 1).mean();
            // Facets of level 6 are inside of the sphere by at most 1e-4 of its radius.
            assert!((measured / expected.0 - 1.0).abs() < 1e-3, "{radius}: {measured} {expected}");
            sphere.add(measured);
        }
        println!("radius {radius}: {:.6} W/m², Φ/(4πr²) = {expected:.6}", sphere.mean());
    }
}

/// E = E₀ cosθ.
#[test]
fn irradiance_falls_with_the_cosine() {
    for degrees in [0.0_f64, 30.0, 60.0, 85.0] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let direction = Vec3::new(sin as f32, -cos as f32, 0.0);
        let sun = Light::Directional { direction, irradiance: Rgb::splat(2.0).into() };
        let floor = shape::quad(Vec3::ZERO, Vec3::Z * 5.0, Vec3::X * 5.0);
        let renderer = scattered_once(lit(floor, vec![sun]));
        let measured = irradiance(&renderer, Vec3::new(0.1, 3.0, 0.2), Vec3::NEG_Y, 1).mean();
        // Single precision: the direction's rounding, over a cosine that may be small.
        let tolerance = 8.0 * f64::from(f32::EPSILON) / cos;
        assert!((measured / (2.0 * cos) - 1.0).abs() < tolerance, "{degrees}°: {measured}");
    }
}

/// E = ∫ L cosθ dω: a square lamp in any position, against Lambert's formula for its projected solid angle.
#[test]
fn irradiance_is_radiance_over_projected_solid_angle() {
    let mut random = HashGenerator::new(2);
    for _ in 0..6 {
        let mut draw = || random.next_f32() - 0.5;
        let center = Vec3::new(2.0 * draw(), 1.5 + draw(), 2.0 * draw());
        let (half_u, half_v) = (Vec3::X * (0.3 + 0.2 * draw()), Vec3::Z * (0.4 + 0.2 * draw()));
        // Its normal u × v looks down.
        assert!(half_u.cross(half_v).y < 0.0);
        let radiance = Radiance(5.0);
        let lamp = Light::Quad { center, half_u, half_v, radiance: Rgb::splat(5.0).into() };
        let corners = [half_u + half_v, half_u - half_v, -half_u - half_v, half_v - half_u];
        let corners = corners.map(|corner| (center + corner).as_dvec3());
        let extent = ProjectedSolidAngle::polygon(&corners, DVec3::ZERO, DVec3::Y);
        let expected = radiance.irradiance(extent).0;
        let floor = shape::quad(Vec3::ZERO, Vec3::Z * 5.0, Vec3::X * 5.0);
        let renderer = scattered_once(lit(floor, vec![lamp]));
        // From the side, under the lamp, at the origin.
        let from = Vec3::new(0.3, 0.2, 0.1);
        let measured = irradiance(&renderer, from, -from.normalize(), 40_000);
        let (mean, sigma) = (measured.mean(), measured.standard_error());
        assert!((mean - expected).abs() < 3.0 * sigma, "{mean} ± {sigma}, expected {expected}");
        assert!(sigma < 5e-3 * expected);
    }
}

/// Two sensors on one ray, near and far, see the same: a lamp exactly, a lit surface with the same light in every sample.
#[test]
fn radiance_is_the_same_all_along_a_ray() {
    let lamp = Light::Sphere { center: Vec3::Y * 2.0, radius: 0.5, radiance: Rgb::splat(4.0).into() };
    let floor = shape::quad(Vec3::ZERO, Vec3::Z * 5.0, Vec3::X * 5.0);
    let renderer = renderer(lit(floor, vec![lamp]));
    let mut counters = Counters::default();
    let toward_floor = Vec3::new(0.6, -0.8, 0.0);
    let seen_from = |distance: f32, sample| {
        let (floor, lamp) = (Vec3::new(1.0, 0.0, 0.5), Vec3::Y * 2.0);
        let floor = renderer.radiance(floor - toward_floor * distance, toward_floor, sample, &mut counters);
        let lamp = renderer.radiance(lamp - Vec3::Z * (distance + 1.0), Vec3::Z, sample, &mut counters);
        [floor[0], lamp[0]].map(f64::from)
    };
    let mut seen_from = seen_from;
    for sample in 0..200 {
        let [near, far] = [0.5, 50.0].map(|distance| seen_from(distance, sample));
        assert_eq!((near[1], far[1]), (4.0, 4.0));
        // The far sensor's ray meets the floor within 50 m × 2⁻²³ of the point; light falls off over a metre.
        assert!((near[0] / far[0] - 1.0).abs() < 1e-4, "{near:?} {far:?}");
    }
}

/// In a closed room whose walls shine with 1 and reflect ϱ, the order k of the Neumann series is ϱ^k, and all is 1/(1 − ϱ).
#[test]
fn orders_in_a_shining_room_are_powers_of_its_reflectance() {
    let mut mesh = shape::sphere(Vec3::ZERO, 1.0, 4);
    mesh.normals.clear();
    let mut scene = lit(mesh, Vec::new());
    scene.materials[0].emission = ColorInput::constant(Rgb::ONE);
    scene.materials[0].double_sided = true;
    scene.camera = Camera { position: Vec3::new(0.1, 0.2, 0.0), target: Vec3::Z, ..Camera::default() };
    let mut renderer = renderer(scene);
    let found = neumann_orders(&mut renderer, 32, 8, 5);
    for term in &found.orders {
        let expected = REFLECTANCE.powi(term.order as i32);
        let error = (term.radiance.value - expected).abs();
        // The light of the order k is that of a path's bounce k; rounding where there is no noise.
        assert!(error <= 3.0 * term.radiance.stderr + 1e-6, "{term:?}, expected {expected}");
    }
    let beyond = REFLECTANCE.powi(9) / (1.0 - REFLECTANCE);
    assert!((found.beyond.value - beyond).abs() <= 3.0 * found.beyond.stderr, "{found:?}");
    assert!((found.sum.value - 2.0).abs() <= 3.0 * found.sum.stderr, "{found:?}");
    assert!(found.sigmas() <= 3.0, "{}", found.sigmas());
    assert!(found.sum.stderr < 0.01);
}

/// With light under surfaces too: the orders of one set of paths add up to the picture by another.
#[test]
fn orders_add_up_to_the_whole_picture() {
    let lamp =
        Light::Sphere { center: Vec3::new(2.0, 3.0, 2.0), radius: 0.5, radiance: Rgb::splat(20.0).into() };
    let mut scene = furnace(shape::sphere(Vec3::ZERO, 1.0, 4), body(1.5, 0.3, 0.05));
    scene.lights = vec![lamp];
    let mut renderer = renderer(scene);
    let found = neumann_orders(&mut renderer, 24, 6, 7);
    let sum: f64 = found.orders.iter().map(|term| term.radiance.value).sum::<f64>() + found.beyond.value;
    // The same samples, in another order of additions.
    assert!((sum / found.sum.value - 1.0).abs() < 1e-9, "{sum} {}", found.sum.value);
    assert!(found.sigmas() <= 3.0, "{found:?}");
    let lost: Vec<f64> = found.orders.iter().map(|term| term.lost_if_cut).collect();
    assert!(lost.windows(2).all(|pair| pair[1] <= pair[0]), "{lost:?}");
    assert!(found.sum.stderr < 0.01 * found.sum.value);
}

/// ∫ dω = 4π: the triangles of any closed mesh, from any point inside.
#[test]
fn all_directions_are_four_pi() {
    let mesh = shape::sphere(Vec3::new(0.3, -0.2, 0.1), 2.0, 4);
    for eye in [DVec3::ZERO, DVec3::new(1.2, -0.9, 0.7), DVec3::new(0.3, -0.2, 2.05)] {
        let corners = |triangle: &[u32; 3]| triangle.map(|v| mesh.positions[v as usize].as_dvec3());
        let sum: SolidAngle =
            mesh.triangles.iter().map(|triangle| SolidAngle::triangle(corners(triangle), eye)).sum();
        // Five thousand roundings, of angles up to π next to the wall.
        assert!((sum.0 - SolidAngle::SPHERE.0).abs() < 1e-11, "{eye}: {}", sum.0);
    }
}

/// A lamp so far away that it is a point: I = L A cosθ, E = I/r².
#[test]
fn a_far_lamp_is_a_point_of_its_intensity() {
    let lamp = Light::Disk {
        center: Vec3::Y * 500.0,
        normal: Vec3::NEG_Y,
        radius: 1.0,
        radiance: Rgb::splat(9.0).into(),
    };
    let intensity: RadiantIntensity = Radiance(9.0) * alabaster::radiometry::Area(PI).projected(1.0);
    let expected = intensity.irradiance(500.0, 1.0).0;
    let floor = shape::quad(Vec3::ZERO, Vec3::Z * 5.0, Vec3::X * 5.0);
    let renderer = scattered_once(lit(floor, vec![lamp]));
    let measured = irradiance(&renderer, Vec3::new(0.0, 1.0, 0.0), Vec3::NEG_Y, 100).mean();
    // The lamp's mesh does not matter to light drawn directly; (radius/distance)² of the cosines.
    assert!((measured / expected - 1.0).abs() < 1e-5, "{measured} {expected}");
}

/// Light that a body without absorption takes from an even sky it gives back, every watt of it.
#[test]
fn a_white_body_absorbs_no_power() {
    let mut renderer = renderer(furnace(shape::sphere(Vec3::ZERO, 1.0, 4), body(1.5, 0.0, 0.05)));
    let balance = renderer.power_balance(20_000).unwrap();
    assert!(balance.sigmas() <= 3.0, "{balance:?}");
    // π · 4π R² of the sphere around, R the half diagonal of the body's box.
    let radius = 3.0_f64.sqrt() * 1.01;
    for c in 0..3 {
        let entered = 4.0 * PI * PI * radius * radius;
        // The box is that of the mesh, smaller by 10⁻³.
        assert!((balance.entered.value[c] / entered - 1.0).abs() < 4e-3, "{balance:?}");
        let absorbed = (balance.absorbed.value[c], balance.absorbed.stderr[c]);
        assert!(absorbed.0.abs() <= 3.0 * absorbed.1 && absorbed.1 < 0.02 * entered, "{absorbed:?}");
        // As much as the body hides of the sky, π · 4π r².
        let out = (balance.scattered_out.value[c], balance.scattered_out.stderr[c]);
        assert!((out.0 - 4.0 * PI * PI).abs() <= 3.0 * out.1 + 0.01 * 4.0 * PI * PI, "{out:?}");
    }
}

/// A lamp over a grey floor: of what reaches the floor it absorbs 1 − ϱ, and all there is comes to what the lamp emits.
#[test]
fn what_a_lamp_emits_is_absorbed_or_leaves() {
    let lamp = Light::Quad {
        center: Vec3::Y,
        half_u: Vec3::X * 0.5,
        half_v: Vec3::Z * 0.5,
        radiance: Rgb::new(1.0, 2.0, 4.0).into(),
    };
    let mut renderer = renderer(lit(shape::quad(Vec3::ZERO, Vec3::Z * 2.0, Vec3::X * 2.0), vec![lamp]));
    let balance = renderer.power_balance(120_000).unwrap();
    assert!(balance.sigmas() <= 3.0, "{balance:?}");
    for (c, radiance) in [1.0, 2.0, 4.0].into_iter().enumerate() {
        let emitted = PI * radiance;
        assert!((balance.emitted.value[c] / emitted - 1.0).abs() < 1e-6, "{balance:?}");
        assert!(balance.residual.stderr[c] < 0.03 * emitted, "{balance:?}");
        assert_eq!(balance.entered.value[c], 0.0);
        let spent = balance.absorbed.value[c] + balance.escaped.value[c] + balance.scattered_out.value[c];
        assert!((emitted - spent - balance.residual.value[c]).abs() < 1e-6 * emitted, "{balance:?}");
    }
}

/// However small the lamps, by colours and by wavelengths.
#[test]
fn the_power_of_small_lamps_is_accounted_for() {
    for mode in [ColorMode::Rgb, ColorMode::Spectral] {
        let lamp = |x: f32, radiance: Rgb| Light::Sphere {
            center: Vec3::new(x, 1.5, 0.2),
            radius: 5e-3,
            radiance: radiance.into(),
        };
        let lamps = vec![lamp(0.7, Rgb::new(3e4, 2e4, 1e4)), lamp(-0.7, Rgb::splat(1e4))];
        let mut scene = lit(shape::quad(Vec3::NEG_Y, Vec3::Z * 2.0, Vec3::X * 2.0), lamps);
        scene.meshes.push(shape::sphere(Vec3::ZERO, 1.0, 4));
        scene.materials.push(body(1.4, 0.3, 0.05));
        let ball = Instance { name: "ball".into(), mesh: 1, material: 1, transform: Affine3A::IDENTITY };
        scene.instances.push(ball);
        scene.render.color_mode = mode;
        let balance = renderer(scene).power_balance(40_000).unwrap();
        println!("{mode:?}: {:?}", balance.residual);
        assert!(balance.sigmas() <= 3.0, "{balance:?}");
        for c in 0..3 {
            let emitted = balance.emitted.value[c];
            assert!(balance.residual.stderr[c] < 0.03 * emitted, "{balance:?}");
            assert!(balance.absorbed.value[c] > 0.0, "{balance:?}");
        }
    }
}

/// Nothing leaves a closed room: what its lamp emits is absorbed, by the walls and by the lamp.
#[test]
fn a_closed_room_keeps_its_light() {
    let mut scene = lit(shape::cuboid(Vec3::ZERO, Vec3::splat(4.0)), Vec::new());
    scene.lights = vec![Light::Sphere { center: Vec3::X * 0.3, radius: 0.5, radiance: Rgb::ONE.into() }];
    let balance = renderer(scene).power_balance(20_000).unwrap();
    assert!(balance.sigmas() <= 3.0, "{balance:?}");
    assert_eq!((balance.escaped.value, balance.scattered_out.value), ([0.0; 3], [0.0; 3]));
    // The lamp's mesh is smaller than the sphere that its power is of, by 10⁻³.
    let (absorbed, sigma) = (balance.absorbed.value[0], balance.absorbed.stderr[0]);
    assert!((absorbed - PI * PI).abs() <= 3.0 * sigma + 2e-3 * PI * PI, "{balance:?}");
    let nothing = Scene {
        meshes: Vec::new(),
        instances: Vec::new(),
        ..lit(shape::sphere(Vec3::ZERO, 1.0, 1), Vec::new())
    };
    assert_eq!(renderer(nothing).power_balance(10).unwrap_err(), Unbalanced::NoGeometry);
}

/// Light that no ray meets is accounted for all the same: of a point and a spot in a closed room the walls absorb all, and of the sun as much comes in as a
/// sphere around the scene has for a cross-section.
#[test]
fn lights_without_size_are_accounted_for() {
    let position = Vec3::new(0.3, 0.5, -0.2);
    let spot = Light::Spot {
        position,
        direction: Vec3::new(0.6, 0.0, 0.8),
        intensity: Rgb::splat(5.0).into(),
        inner_angle: 0.3,
        outer_angle: 0.9,
    };
    for light in [Light::Point { position, intensity: Rgb::new(1.0, 2.0, 3.0).into() }, spot] {
        let RadiantFlux(power) = light.power().unwrap();
        let room = lit(shape::cuboid(Vec3::ZERO, Vec3::splat(4.0)), vec![light]);
        let balance = renderer(room).power_balance(20_000).unwrap();
        assert!(balance.sigmas() <= 3.0, "{balance:?}");
        for c in 0..3 {
            let (absorbed, sigma) = (balance.absorbed.value[c], balance.absorbed.stderr[c]);
            assert!((absorbed - f64::from(power[c])).abs() <= 3.0 * sigma, "{balance:?}");
            assert!(sigma < 0.05 * absorbed, "{balance:?}");
        }
    }
    let sun = Light::Directional { direction: Vec3::new(0.6, -0.8, 0.0), irradiance: Rgb::splat(2.0).into() };
    let floor = lit(shape::quad(Vec3::ZERO, Vec3::Z * 2.0, Vec3::X * 2.0), vec![sun]);
    let balance = renderer(floor).power_balance(40_000).unwrap();
    assert!(balance.sigmas() <= 3.0, "{balance:?}");
    // The sphere is a hundredth larger than the half diagonal of the floor, √8.
    let entered = 2.0 * PI * 8.0 * 1.01_f64.powi(2);
    assert!((balance.entered.value[1] / entered - 1.0).abs() < 1e-5, "{balance:?}");
    // E cosθ on 16 m², half of it absorbed.
    let (absorbed, sigma) = (balance.absorbed.value[1], balance.absorbed.stderr[1]);
    assert!((absorbed - 2.0 * 0.8 * 16.0 * 0.5).abs() <= 3.0 * sigma, "{balance:?}");
}
