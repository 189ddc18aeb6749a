//! A kernel has code for some effects only. Whatever it is, the picture is that of the generic kernel, bit for bit: random numbers
//! belong to places, not to effects.

#[path = "common/scenes.rs"]
#[allow(dead_code)]
mod scenes;

use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use alabaster::film::Film;
use alabaster::math::sampler::HashGenerator;
use alabaster::plan::{EffectKind, Forces, Kernel};
use alabaster::radiometry::Rgb;
use alabaster::scene::material::{Coverage, MetallicRoughness};
use alabaster::scene::texture::{Pixels, Wrap};
use alabaster::scene::{
    Camera, ColorInput, ColorMode, Environment, FilmSettings, Filter, Image, Instance, Light, Material, Mesh,
    Method, ScalarInput, ScatteringInput, Scene, Surface, Texture, read_scene, shape,
};
use alabaster::transport::{RenderOptions, Renderer};
use glam::{Affine2, Affine3A, Vec2, Vec3, Vec4};
use scenes::{Caster, caster, options};

const SIDE: u32 = 12;

/// The bits of all pixels, and what was counted on the way.
fn picture(renderer: &Renderer<Caster>) -> (Vec<[u32; 3]>, String) {
    let mut film = Film::new(SIDE, SIDE).unwrap();
    let counters = renderer.expose(&mut film, 0..2, &AtomicBool::new(false), &|_| ());
    let bits = film.picture().pixels.iter().map(|pixel| pixel.0.map(f32::to_bits)).collect();
    (bits, format!("{counters:?}"))
}

/// Renders by red, green and blue with every kernel that suits; returns the one that was chosen, and whether the picture is not black.
fn all_kernels_agree(name: &str, mut scene: Scene, options: RenderOptions) -> (Kernel, bool) {
    scene.film = FilmSettings { width: SIDE, height: SIDE, filter: Filter::Box };
    scene.render.color_mode = ColorMode::Rgb;
    let mut renderer = Renderer::new(scene, options, caster).unwrap_or_else(|e| panic!("{name}: {e}"));
    let chosen = renderer.kernel();
    assert!(renderer.use_kernel(Kernel::Generic));
    let generic = picture(&renderer);
    let others = Kernel::ALL.into_iter().filter(|&kernel| kernel != Kernel::Generic);
    let suiting = others.filter(|&kernel| renderer.use_kernel(kernel).then_some(()).is_some());
    for kernel in suiting.collect::<Vec<_>>() {
        assert!(renderer.use_kernel(kernel));
        assert_eq!(renderer.kernel(), kernel);
        assert!(picture(&renderer) == generic, "{name}: {} is not {}", kernel.name(), chosen.name());
    }
    (chosen, generic.0.iter().flatten().any(|&bits| bits != 0))
}

fn scene_files() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let mut files: Vec<PathBuf> =
        std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.retain(|file| file.extension().is_some_and(|ending| ending == "toml" || ending == "glb"));
    files.sort();
    files
}

#[test]
fn on_every_scene_file() {
    let files = scene_files();
    assert!(files.len() >= 15, "{files:?}");
    for file in files {
        let scene = read_scene(&file).unwrap();
        let name = file.file_name().unwrap().to_string_lossy().into_owned();
        let asked = [scene.subsurface.method, Method::Walk, Method::Diffuse];
        let is_translucent = name.ends_with(".toml")
            && scene.materials.iter().any(|material| matches!(material.surface, Surface::Translucent { .. }));
        for method in asked.into_iter().take(if is_translucent { 3 } else { 1 }) {
            let options = RenderOptions { method, ..options() };
            let (chosen, lit) = all_kernels_agree(&name, scene.clone(), options);
            assert!(lit, "{name}");
            if is_translucent && method == Method::Walk {
                assert_eq!(chosen, Kernel::Generic);
            }
        }
    }
}

/// What a random scene is made of.
struct Dice(HashGenerator);

impl Dice {
    fn number(&mut self) -> f32 {
        self.0.next_f32()
    }

    fn chance(&mut self, probability: f32) -> bool {
        self.number() < probability
    }

    fn color(&mut self) -> Rgb {
        Rgb::from_fn(|_| 0.1 + 0.8 * self.number())
    }

    fn place(&mut self) -> Vec3 {
        Vec3::from_array([(); 3].map(|()| 2.0 * self.number() - 1.0))
    }

    fn color_input(&mut self, textured: bool) -> ColorInput {
        let texture = (textured && self.chance(0.7)).then_some(0);
        ColorInput { factor: self.color(), texture, vertex_color: textured && self.chance(0.5) }
    }

    fn scalar_input(&mut self, textured: bool) -> ScalarInput {
        let texture = (textured && self.chance(0.5)).then_some((1, (4.0 * self.number()) as usize));
        ScalarInput { factor: self.number(), texture, vertex_alpha: false }
    }

    fn image(&mut self) -> Image {
        let pixels = (0..64).map(|_| [(); 4].map(|()| (256.0 * self.number()) as u8)).collect();
        Image { name: "noise".into(), width: 8, height: 8, pixels: Pixels::Rgba8(pixels) }
    }

    /// Opaque, or thin: paths stay in the air.
    fn surface(&mut self, textured: bool) -> Surface {
        match (4.0 * self.number()) as u32 {
            0 => Surface::Diffuse { reflectance: self.color_input(textured) },
            1 => Surface::Metal {
                reflectance: self.color_input(textured),
                roughness: self.scalar_input(textured),
            },
            _ => self.metallic_roughness(textured, true),
        }
    }

    fn metallic_roughness(&mut self, textured: bool, thin: bool) -> Surface {
        Surface::MetallicRoughness(Box::new(MetallicRoughness {
            base_color: self.color_input(textured),
            metallic: ScalarInput::constant(0.3),
            roughness: self.scalar_input(textured),
            ior: 1.0 + self.number(),
            transmission: if self.chance(0.5) || !thin {
                self.scalar_input(false)
            } else {
                ScalarInput::constant(0.0)
            },
            diffuse_transmission: self.scalar_input(textured),
            diffuse_transmission_color: self.color_input(textured),
            thin,
            sigma_a: self.color(),
            dispersion: None,
        }))
    }

    fn clear(&mut self, textured: bool) -> Surface {
        if self.chance(0.3) {
            return self.metallic_roughness(textured, false);
        }
        Surface::Dielectric {
            ior: 1.1 + 0.6 * self.number(),
            dispersion: None,
            roughness: if self.chance(0.5) {
                self.scalar_input(textured)
            } else {
                ScalarInput::constant(0.0)
            },
            sigma_a: self.color(),
            tint: self.color_input(textured),
        }
    }

    fn translucent(&mut self, textured: bool) -> Surface {
        let g = if self.chance(0.5) { 0.0 } else { 0.8 * self.number() };
        let medium = if self.chance(0.5) {
            ScatteringInput::Coefficients { sigma_a: self.color(), sigma_s: self.color() * 20.0, g }
        } else {
            let albedo = self.color_input(textured);
            ScatteringInput::Albedo { albedo, mean_free_path: self.color() * 0.2, g }
        };
        let roughness = if self.chance(0.5) { 0.0 } else { self.number() };
        Surface::Translucent { ior: 1.0 + 0.5 * self.number(), roughness, medium }
    }

    fn material(&mut self, name: &str, surface: Surface, textured: bool, covered: bool) -> Material {
        let alpha = ScalarInput { factor: 0.9, texture: textured.then_some((0, 3)), vertex_alpha: false };
        let coverage = match covered {
            true => Coverage::Full,
            false if self.chance(0.5) => Coverage::Blend { alpha },
            false => Coverage::Mask { alpha, cutoff: 0.4 },
        };
        Material {
            name: name.into(),
            surface,
            emission: if self.chance(0.2) { self.color_input(textured) } else { ColorInput::default() },
            normal_map: (textured && self.chance(0.5)).then(|| (1, self.number())),
            coverage,
            double_sided: self.chance(0.5),
        }
    }

    fn lights(&mut self, scene: &mut Scene) {
        scene.environment = self.chance(0.7).then(|| Environment::Constant(self.color()));
        scene.lights = vec![Light::Sphere {
            center: Vec3::new(1.5, 3.0, 2.0),
            radius: 0.5,
            radiance: Rgb::splat(9.0).into(),
        }];
        if self.chance(0.5) {
            scene.lights.push(Light::Point {
                position: self.place() * 2.0 + Vec3::Y * 3.0,
                intensity: self.color().into(),
            });
        }
        if self.chance(0.5) {
            let direction = (self.place() - Vec3::Y * 2.0).normalize();
            scene.lights.push(Light::Directional { direction, irradiance: self.color().into() });
        }
    }
}

/// A sphere that has all that vertices can have.
fn ball(dice: &mut Dice, center: Vec3, radius: f32) -> Mesh {
    let mut mesh = shape::sphere(center, radius, 2);
    mesh.normals = mesh.positions.iter().map(|p| (*p - center).normalize()).collect();
    mesh.tangents = mesh.normals.iter().map(|n| n.any_orthonormal_vector().extend(1.0)).collect();
    let coordinates: Vec<Vec2> = mesh.positions.iter().map(|p| Vec2::new(p.x, p.y + p.z)).collect();
    mesh.texture_coordinates = [coordinates.clone(), coordinates];
    mesh.colors = mesh.positions.iter().map(|_| Vec4::new(dice.number(), 0.5, dice.number(), 1.0)).collect();
    mesh
}

/// Which kinds of things a random scene may have.
#[derive(Clone, Copy, Debug)]
struct Kinds {
    textures: bool,
    cut_out: bool,
    clear: bool,
    translucent: bool,
}

fn random_scene(seed: u64, kinds: Kinds) -> Scene {
    let mut dice = Dice(HashGenerator::new(seed));
    let mut scene = Scene {
        camera: Camera { position: Vec3::new(0.0, 1.0, 5.0), vertical_fov: 0.9, ..Camera::default() },
        images: vec![dice.image(), dice.image()],
        ..Scene::default()
    };
    scene.camera.aperture = if dice.chance(0.5) { 0.1 } else { 0.0 };
    scene.textures = (0..2)
        .map(|image| Texture {
            image,
            coordinate_set: image,
            transform: Affine2::from_scale(Vec2::splat(1.3)),
            wrap_u: Wrap::Repeat,
            wrap_v: Wrap::Mirror,
            nearest: dice.chance(0.5),
            srgb: image == 0,
        })
        .collect();
    dice.lights(&mut scene);
    for i in 0..6 {
        let surface = match i {
            0 | 1 if kinds.translucent => dice.translucent(kinds.textures),
            2 | 3 if kinds.clear => dice.clear(kinds.textures),
            _ => dice.surface(kinds.textures),
        };
        let material =
            dice.material(&format!("material {i}"), surface, kinds.textures, !(kinds.cut_out && i > 1));
        scene.materials.push(material);
        let (center, radius) = (dice.place(), 0.4 + 0.6 * dice.number());
        let mesh = ball(&mut dice, center, radius);
        scene.meshes.push(mesh);
        let transform = match dice.chance(0.5) {
            true => Affine3A::IDENTITY,
            false => Affine3A::from_scale(Vec3::new(0.8, -1.1, 0.9)),
        };
        scene.instances.push(Instance { name: format!("ball {i}"), mesh: i, material: i, transform });
    }
    scene
}

#[test]
fn on_random_scenes() {
    let mut chosen = HashSet::new();
    for seed in 0..32_u64 {
        let bit = |place: u64| seed >> place & 1 == 1;
        let kinds = Kinds { textures: bit(0), cut_out: bit(1), clear: bit(2), translucent: bit(3) };
        let method = if bit(4) { Method::Walk } else { Method::Bssrdf };
        let options = RenderOptions { method, seed, ..options() };
        let name = format!("seed {seed}, {kinds:?}");
        let (kernel, lit) = all_kernels_agree(&name, random_scene(seed, kinds), options);
        assert!(lit, "{name}");
        chosen.insert(kernel.name());
    }
    // Every kernel but the spectral one, whose picture is another, has been tried against the generic one.
    assert_eq!(chosen.len(), Kernel::ALL.len() - 1, "{chosen:?}");
}

#[test]
fn code_that_is_kept_changes_nothing() {
    let scene = read_scene(&scene_files()[0]).unwrap();
    let mut small = scene;
    small.film = FilmSettings { width: SIDE, height: SIDE, filter: Filter::Box };
    let forced = Forces::new([(EffectKind::Textures, true), (EffectKind::NestedMedia, true)]).unwrap();
    let plain = Renderer::new(small.clone(), options(), caster).unwrap();
    let kept = Renderer::new(small, RenderOptions { forces: forced, ..options() }, caster).unwrap();
    assert_eq!((plain.kernel(), kept.kernel()), (Kernel::Subsurface, Kernel::Generic));
    assert!(picture(&plain) == picture(&kept));
}

#[test]
fn a_kernel_that_does_not_suit_is_refused() {
    let scene = read_scene(&scene_files()[0]).unwrap();
    let mut renderer = Renderer::new(scene, options(), caster).unwrap();
    assert!(!renderer.use_kernel(Kernel::Surfaces) && renderer.kernel() == Kernel::Subsurface);
}
