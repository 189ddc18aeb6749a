//! Random scenes that shrink: a few bodies, a light, a sky.

use alabaster::radiometry::Rgb;
use alabaster::scene::{
    Camera, ColorInput, Environment, Instance, Light, Material, Mesh, Method, ScalarInput, ScatteringInput,
    Scene, Surface, shape,
};
use glam::{Affine3A, Quat, Vec3};
use proptest::prelude::*;

use crate::common::scenes::l_shape;

/// All that a random scene is made of.
#[derive(Clone, Debug)]
pub struct Recipe {
    method: Method,
    bodies: Vec<Body>,
    light: Source,
    sky: [f32; 3],
}

#[derive(Clone, Debug)]
struct Body {
    form: Form,
    matter: Matter,
    /// Along its axes.
    scale: [f32; 3],
    angles: [f32; 2],
    center: [f32; 3],
}

#[derive(Clone, Copy, Debug)]
enum Form {
    Ball,
    Block,
    Corner,
}

#[derive(Clone, Copy, Debug)]
enum Matter {
    Translucent { ior: f32, roughness: f32, albedo: [f32; 3], free_path: [f32; 3], g: f32 },
    Glass { ior: f32, absorption: f32 },
    Plaster([f32; 3]),
    Brass { roughness: f32 },
}

#[derive(Clone, Copy, Debug)]
enum Source {
    Lamp { radius: f32 },
    Window { width: f32 },
    Point,
    Sun,
}

pub fn recipe() -> impl Strategy<Value = Recipe> {
    let method = prop_oneof![Just(Method::Bssrdf), Just(Method::Walk)];
    let light = prop_oneof![
        Just(Source::Sun),
        Just(Source::Point),
        (0.2_f32..1.0).prop_map(|radius| Source::Lamp { radius }),
        (0.3_f32..2.0).prop_map(|width| Source::Window { width }),
    ];
    (method, prop::collection::vec(body(), 1..4), light, [0.0_f32..1.0, 0.0_f32..1.0, 0.0_f32..1.0])
        .prop_map(|(method, bodies, light, sky)| Recipe { method, bodies, light, sky })
}

fn body() -> impl Strategy<Value = Body> {
    let form = prop_oneof![Just(Form::Ball), Just(Form::Block), Just(Form::Corner)];
    let three = |range: std::ops::Range<f32>| [range.clone(), range.clone(), range];
    (form, matter(), three(0.3..1.0), [0.0_f32..3.0, 0.0_f32..3.0], three(-0.8..0.8))
        .prop_map(|(form, matter, scale, angles, center)| Body { form, matter, scale, angles, center })
}

fn matter() -> impl Strategy<Value = Matter> {
    let three = |range: std::ops::Range<f32>| [range.clone(), range.clone(), range];
    let ior = prop_oneof![Just(1.0_f32), 1.2_f32..1.7];
    let roughness = prop_oneof![Just(0.0_f32), 0.2_f32..0.8];
    prop_oneof![
        4 => (ior, roughness, three(0.1..0.95), three(0.02..0.3), -0.3_f32..0.7)
            .prop_map(|(ior, roughness, albedo, free_path, g)| Matter::Translucent { ior, roughness, albedo, free_path, g }),
        1 => (1.2_f32..1.7, 0.0_f32..2.0).prop_map(|(ior, absorption)| Matter::Glass { ior, absorption }),
        1 => three(0.1..0.9).prop_map(Matter::Plaster),
        1 => (0.2_f32..0.8).prop_map(|roughness| Matter::Brass { roughness }),
    ]
}

impl Recipe {
    pub fn scene(&self) -> Scene {
        let mut scene = Scene {
            camera: Camera {
                position: Vec3::new(1.5, 2.5, 4.0),
                vertical_fov: 35.0_f32.to_radians(),
                ..Camera::default()
            },
            lights: vec![self.light.light()],
            environment: Some(Environment::Constant(Rgb::new(self.sky[0], self.sky[1], self.sky[2]))),
            ..Scene::default()
        };
        scene.subsurface.method = self.method;
        for (index, body) in self.bodies.iter().enumerate() {
            scene.meshes.push(body.form.mesh());
            scene.materials.push(body.matter.material());
            let rotation = Quat::from_rotation_y(body.angles[0]) * Quat::from_rotation_x(body.angles[1]);
            let transform =
                Affine3A::from_scale_rotation_translation(body.scale.into(), rotation, body.center.into());
            scene.instances.push(Instance {
                name: format!("body {index}"),
                mesh: index,
                material: index,
                transform,
            });
        }
        scene
    }
}

impl Form {
    fn mesh(self) -> Mesh {
        match self {
            Self::Ball => shape::sphere(Vec3::ZERO, 1.0, 4),
            Self::Block => shape::cuboid(Vec3::ZERO, Vec3::splat(1.5)),
            Self::Corner => l_shape(),
        }
    }
}

impl Matter {
    fn material(self) -> Material {
        let rgb = |[r, g, b]: [f32; 3]| Rgb::new(r, g, b);
        let surface = match self {
            Self::Translucent { ior, roughness, albedo, free_path, g } => Surface::Translucent {
                ior,
                roughness,
                medium: ScatteringInput::Albedo {
                    albedo: ColorInput::constant(rgb(albedo)),
                    mean_free_path: rgb(free_path),
                    g,
                },
            },
            Self::Glass { ior, absorption } => Surface::Dielectric {
                ior,
                dispersion: None,
                roughness: ScalarInput::constant(0.0),
                sigma_a: Rgb::new(0.2, 0.6, 1.0) * absorption,
                tint: ColorInput::constant(Rgb::ONE),
            },
            Self::Plaster(reflectance) => {
                Surface::Diffuse { reflectance: ColorInput::constant(rgb(reflectance)) }
            }
            Self::Brass { roughness } => Surface::Metal {
                reflectance: ColorInput::constant(Rgb::new(0.9, 0.7, 0.3)),
                roughness: ScalarInput::constant(roughness),
            },
        };
        Material { surface, emission: ColorInput::constant(Rgb::ZERO), ..Material::default() }
    }
}

impl Source {
    fn light(self) -> Light {
        let center = Vec3::new(2.0, 4.0, 1.0);
        match self {
            Self::Lamp { radius } => {
                Light::Sphere { center, radius, radiance: Rgb::new(6.0, 5.0, 4.0).into() }
            }
            Self::Window { width } => Light::Quad {
                center,
                half_u: Vec3::Z * width,
                half_v: Vec3::X * width,
                radiance: Rgb::new(4.0, 5.0, 6.0).into(),
            },
            Self::Point => Light::Point { position: center, intensity: Rgb::splat(20.0).into() },
            Self::Sun => Light::Directional {
                direction: -center.normalize(),
                irradiance: Rgb::new(2.0, 1.9, 1.7).into(),
            },
        }
    }
}
