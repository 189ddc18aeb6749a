//! Scenes made in code, and statistics, for the tests.

use alabaster::plan::Forces;
use alabaster::radiometry::Rgb;
#[cfg(not(feature = "embree"))]
use alabaster::raycast::bvh::BvhCaster;
#[cfg(feature = "embree")]
use alabaster::raycast::embree::EmbreeCaster;
use alabaster::raycast::{Geometry, RaycastError};
use alabaster::scene::{
    Camera, ColorInput, Environment, FilmSettings, Filter, Instance, Material, Mesh, Method, ProfileChoice,
    ScatteringInput, Scene, Surface, shape,
};
use alabaster::transport::{RenderOptions, Renderer};
use glam::{Affine3A, Vec3};

/// The default backend of this build.
#[cfg(feature = "embree")]
pub type Caster = EmbreeCaster;
#[cfg(not(feature = "embree"))]
pub type Caster = BvhCaster;

/// A ray caster for `geometry`.
pub fn caster(geometry: &Geometry) -> Result<Caster, RaycastError> {
    #[cfg(feature = "embree")]
    return EmbreeCaster::new(geometry, 1);
    #[cfg(not(feature = "embree"))]
    BvhCaster::new(geometry)
}

/// Mean and variance of a stream of numbers.
#[derive(Default)]
pub struct Statistics {
    count: f64,
    sum: f64,
    squares: f64,
    pub max: f64,
}

impl Statistics {
    pub fn add(&mut self, x: f64) {
        self.count += 1.0;
        self.sum += x;
        self.squares += x * x;
        self.max = self.max.max(x);
    }

    /// Adds the numbers of `other`.
    pub fn merge(&mut self, other: &Self) {
        self.count += other.count;
        self.sum += other.sum;
        self.squares += other.squares;
        self.max = self.max.max(other.max);
    }

    pub fn count(&self) -> f64 {
        self.count
    }

    pub fn mean(&self) -> f64 {
        self.sum / self.count
    }

    /// Of the mean, for independent numbers.
    pub fn standard_error(&self) -> f64 {
        let mean = self.mean();
        ((self.squares / self.count - mean * mean).max(0.0) / (self.count - 1.0)).sqrt()
    }
}

/// A material that absorbs nothing and scatters alike in all directions, σ_s = `sigma_s`.
pub fn white(eta: f32, roughness: f32, sigma_s: Rgb) -> Material {
    Material {
        name: "white".into(),
        surface: Surface::Translucent {
            ior: eta,
            roughness,
            medium: ScatteringInput::Coefficients { sigma_a: Rgb::ZERO, sigma_s, g: 0.0 },
        },
        emission: ColorInput::constant(Rgb::ZERO),
        ..Material::default()
    }
}

/// A translucent material that absorbs nothing; the channels differ in mean free path.
pub fn body(eta: f32, roughness: f32, free_path: f32) -> Material {
    white(eta, roughness, Rgb::new(1.0, 0.8, 1.6) / free_path)
}

/// One mesh in uniform light of radiance 1, filling most of the picture.
pub fn furnace(mesh: Mesh, material: Material) -> Scene {
    Scene {
        camera: Camera {
            position: Vec3::new(1.5, 2.5, 4.0),
            vertical_fov: 25.0_f32.to_radians(),
            ..Camera::default()
        },
        film: FilmSettings { width: 24, height: 24, filter: Filter::Box },
        meshes: vec![mesh],
        instances: vec![Instance {
            name: "body".into(),
            mesh: 0,
            material: 0,
            transform: Affine3A::IDENTITY,
        }],
        materials: vec![material],
        environment: Some(Environment::Constant(Rgb::ONE)),
        ..Scene::default()
    }
}

pub fn options() -> RenderOptions {
    RenderOptions {
        seed: 1,
        method: Method::Bssrdf,
        accuracy: 0.02,
        profile: ProfileChoice::Auto,
        max_depth: 0,
        spheres: true,
        guiding: true,
        similarity: false,
        forces: Forces::default(),
    }
}

pub fn renderer(scene: Scene) -> Renderer<Caster> {
    Renderer::new(scene, options(), caster).unwrap()
}

pub fn renderer_with(scene: Scene, profile: ProfileChoice) -> Renderer<Caster> {
    Renderer::new(scene, RenderOptions { profile, ..options() }, caster).unwrap()
}

/// Meshes joined into one.
pub fn join(parts: impl IntoIterator<Item = Mesh>) -> Mesh {
    let mut joined = Mesh::default();
    for part in parts {
        let first = joined.positions.len() as u32;
        joined.positions.extend(&part.positions);
        joined.normals.extend(&part.normals);
        joined.triangles.extend(part.triangles.iter().map(|t| t.map(|v| v + first)));
    }
    joined
}

/// A floor and a wall that meet in a concave corner, as one closed body (a prism over an L).
pub fn l_shape() -> Mesh {
    let outline = [[-1.0, -1.0], [1.0, -1.0], [1.0, -0.6], [-0.6, -0.6], [-0.6, 1.0], [-1.0, 1.0]];
    let mut mesh = Mesh::default();
    for z in [-1.0, 1.0] {
        mesh.positions.extend(outline.map(|[x, y]: [f32; 2]| Vec3::new(x, y, z)));
    }
    // Two quads make each cap.
    for [a, b, c, d] in [[0, 1, 2, 3], [0, 3, 4, 5]] {
        mesh.triangles.extend([[a, c, b], [a, d, c], [a + 6, b + 6, c + 6], [a + 6, c + 6, d + 6]]);
    }
    for i in 0..6 {
        let j = (i + 1) % 6;
        mesh.triangles.extend([[i, j, j + 6], [i, j + 6, i + 6]]);
    }
    mesh
}

/// Two slabs of one body with a gap of 0.1 between them.
pub fn two_slabs() -> Mesh {
    join([-0.25, 0.25].map(|y| shape::cuboid(Vec3::new(0.0, y, 0.0), Vec3::new(4.0, 0.4, 4.0))))
}

/// The objects of `scene`, all of `material`, in uniform light of radiance 1.
pub fn in_furnace(mut scene: Scene, material: Material) -> Scene {
    scene.materials = vec![material];
    scene.instances.iter_mut().for_each(|instance| instance.material = 0);
    scene.lights.clear();
    scene.environment = Some(Environment::Constant(Rgb::ONE));
    scene
}
