//! What is constant in a scene is folded before its effects are counted, and the folded scene is the same one.

#[path = "common/scenes.rs"]
#[allow(dead_code)]
mod scenes;

use alabaster::plan::fold::fold;
use alabaster::plan::{Abilities, EffectKind, Kernel, Plan, Request};
use alabaster::radiometry::Rgb;
use alabaster::radiometry::color::srgb_to_linear;
use alabaster::scene::material::{Coverage, MetallicRoughness};
use alabaster::scene::texture::{Pixels, Wrap};
use alabaster::scene::{
    ColorInput, Environment, Image, Material, ScalarInput, ScatteringInput, Scene, Surface, Texture, shape,
};
use glam::{Affine2, Vec2, Vec3, Vec4};
use scenes::furnace;

/// One sphere of `material`, with textures 0 of one pixel's colour and 1 of two, in sRGB, and with all that vertices can have.
fn scene(material: Material) -> Scene {
    let mut mesh = shape::sphere(Vec3::ZERO, 1.0, 1);
    let vertices = mesh.positions.len();
    mesh.tangents = vec![Vec4::X; vertices];
    mesh.texture_coordinates = [vec![Vec2::ZERO; vertices], vec![Vec2::ZERO; vertices]];
    mesh.colors = vec![Vec4::ONE; vertices];
    let image = |pixels: Vec<[u8; 4]>| Image {
        name: String::new(),
        width: pixels.len() as u32,
        height: 1,
        pixels: Pixels::Rgba8(pixels),
    };
    let texture = |image| Texture {
        image,
        coordinate_set: image,
        transform: Affine2::IDENTITY,
        wrap_u: Wrap::Repeat,
        wrap_v: Wrap::Repeat,
        nearest: false,
        srgb: true,
    };
    let mut scene = furnace(mesh, material);
    scene.images = vec![image(vec![[51, 102, 255, 255]; 3]), image(vec![[0, 9, 9, 255], [255, 9, 9, 255]])];
    scene.textures = vec![texture(0), texture(1)];
    scene
}

fn diffuse(reflectance: ColorInput) -> Material {
    Material { surface: Surface::Diffuse { reflectance }, ..Material::default() }
}

fn textured(factor: f32, texture: usize) -> ColorInput {
    ColorInput { factor: Rgb::splat(factor), texture: Some(texture), vertex_color: true }
}

fn folded(material: Material) -> Scene {
    let mut scene = scene(material);
    fold(&mut scene);
    let once = format!("{scene:?}");
    fold(&mut scene);
    assert_eq!(format!("{scene:?}"), once, "folding again changes nothing");
    scene
}

fn reflectance(scene: &Scene) -> ColorInput {
    match scene.materials[0].surface {
        Surface::Diffuse { reflectance } => reflectance,
        ref other => panic!("{other:?}"),
    }
}

fn kernel(material: Material) -> Kernel {
    let mut scene = scene(material);
    let request = Request::from(&scene.subsurface);
    Plan::prepare(&mut scene, &request).unwrap().kernel
}

#[test]
fn constant_textures_and_white_vertices_become_factors() {
    let constant = folded(diffuse(textured(0.5, 0)));
    let linear = [51, 102, 255].map(|code| 0.5 * srgb_to_linear(f32::from(code as u8) / 255.0));
    assert_eq!(reflectance(&constant), ColorInput::constant(Rgb::new(linear[0], linear[1], linear[2])));
    let mesh = &constant.meshes[0];
    assert!(mesh.tangents.is_empty() && mesh.colors.is_empty());
    assert!(mesh.texture_coordinates.iter().all(Vec::is_empty));
    assert!(constant.images.iter().all(|image| (image.width, image.height) == (1, 1)));

    let varying = folded(diffuse(textured(0.5, 1)));
    assert_eq!(reflectance(&varying).texture, Some(1));
    assert!(!reflectance(&varying).vertex_color);
    let sets = &varying.meshes[0].texture_coordinates;
    assert!(sets[0].is_empty() && !sets[1].is_empty());
    assert_eq!((varying.images[0].width, varying.images[1].width), (1, 2));
    assert_eq!(reflectance(&folded(diffuse(textured(0.0, 1)))), ColorInput::constant(Rgb::ZERO));
}

#[test]
fn coloured_vertices_are_kept() {
    let mut scene = scene(diffuse(textured(0.5, 0)));
    scene.meshes[0].colors[0] = Vec4::new(1.0, 0.5, 1.0, 1.0);
    fold(&mut scene);
    assert!(reflectance(&scene).vertex_color && !scene.meshes[0].colors.is_empty());
}

#[test]
fn what_covers_everything_is_full() {
    let with = |coverage| Material { coverage, ..diffuse(ColorInput::constant(Rgb::ONE)) };
    let alpha = |factor, texture| ScalarInput { factor, texture, vertex_alpha: true };
    let full = [
        Coverage::Blend { alpha: alpha(1.0, Some((1, 3))) },
        Coverage::Blend { alpha: alpha(1.0, None) },
        Coverage::Mask { alpha: alpha(0.5, None), cutoff: 0.5 },
        Coverage::Mask { alpha: alpha(1.0, Some((1, 0))), cutoff: 0.0 },
    ];
    for coverage in full {
        assert_eq!(folded(with(coverage)).materials[0].coverage, Coverage::Full, "{coverage:?}");
        assert_eq!(kernel(with(coverage)), Kernel::Surfaces);
    }
    let partial = [
        Coverage::Blend { alpha: alpha(0.9, None) },
        Coverage::Mask { alpha: alpha(0.4, None), cutoff: 0.5 },
        Coverage::Mask { alpha: alpha(1.0, Some((1, 0))), cutoff: 0.5 },
    ];
    for coverage in partial {
        assert_ne!(folded(with(coverage)).materials[0].coverage, Coverage::Full, "{coverage:?}");
        assert_eq!(kernel(with(coverage)), Kernel::Textures);
    }
}

fn metallic(metallic: f32) -> Material {
    let surface = Surface::MetallicRoughness(Box::new(MetallicRoughness {
        base_color: ColorInput::constant(Rgb::ONE),
        metallic: ScalarInput::constant(metallic),
        roughness: ScalarInput::constant(0.5),
        ior: 1.5,
        transmission: ScalarInput::constant(1.0),
        diffuse_transmission: ScalarInput::constant(0.0),
        diffuse_transmission_color: ColorInput::constant(Rgb::ONE),
        thin: false,
        sigma_a: Rgb::ONE,
        dispersion: None,
    }));
    Material { surface, ..Material::default() }
}

#[test]
fn metals_transmit_nothing_and_media_without_scattering_are_clear() {
    assert_eq!(kernel(metallic(1.0)), Kernel::Surfaces);
    assert_eq!(kernel(metallic(0.9)), Kernel::Glass);
    let translucent = |sigma_s| Material {
        surface: Surface::Translucent {
            ior: 1.3,
            roughness: 0.0,
            medium: ScatteringInput::Coefficients { sigma_a: Rgb::ONE, sigma_s, g: 0.0 },
        },
        ..Material::default()
    };
    assert_eq!(kernel(translucent(Rgb::ZERO)), Kernel::Glass);
    assert_eq!(kernel(translucent(Rgb::new(0.0, 0.0, 1.0))), Kernel::Generic, "a thin body is walked in");
}

#[test]
fn what_is_not_placed_calls_for_nothing() {
    let mut scene = scene(diffuse(ColorInput::constant(Rgb::ONE)));
    scene.materials.push(metallic(0.0));
    scene.materials.push(diffuse(textured(1.0, 1)));
    // An object without triangles is none.
    scene.meshes.push(Default::default());
    let mut nowhere = scene.instances[0].clone();
    (nowhere.mesh, nowhere.material) = (1, 1);
    scene.instances.push(nowhere);
    scene.environment = Some(Environment::Constant(Rgb::ZERO));
    let request = Request::from(&scene.subsurface);
    let plan = Plan::prepare(&mut scene, &request).unwrap();
    assert_eq!((plan.needed, plan.kernel), (Abilities::NONE, Kernel::Surfaces));
    for kind in [EffectKind::Refraction, EffectKind::Textures, EffectKind::Environment] {
        assert!(!plan.effects[kind as usize].on, "{kind:?}");
    }
    assert!(scene.environment.is_none());
}
