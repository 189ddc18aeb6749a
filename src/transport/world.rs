//! The scene as rays meet it: geometry baked and handed to the ray caster, hits turned into points.

use glam::{Affine3A, Mat3A, Vec2, Vec3, Vec4};

use crate::math::robust::{interpolation_error, offset_from_surface};
use crate::medium::Medium;
use crate::plan::Abilities;
use crate::plan::solid::Flaw;
use crate::raycast::{Geometry, Hit, MeshInstance, Ray, RayCaster, RaycastError, TriangleMesh};
use crate::scene::material::Coverage;
use crate::scene::shape::light_mesh;
use crate::scene::{Instance, Method, Scene};

use super::clearance::surroundings;
use super::contact::neighbours;
use super::interiors::{Interior, Interiors};
use super::placement::{Placement, mirrors};
use super::substance::{Substance, flaws_of_bodies, interior_of};

/// A direction to look for the bodies around a point: any would do that is not along a face, and upwards most scenes are open.
pub const UPWARDS: Vec3 = Vec3::new(0.02, 0.999_8, 0.005);

/// A point on a surface.
#[derive(Clone, Copy, Debug)]
pub struct SurfacePoint {
    /// Position, m.
    pub position: Vec3,
    /// Bound on the absolute error of each coordinate.
    pub error: Vec3,
    /// Unit normal of the triangle, outward by its winding.
    pub geometric_normal: Vec3,
    /// Unit interpolated normal, on the side of the geometric one.
    pub shading_normal: Vec3,
    /// Unit tangent and the sign of the bitangent; zero if the mesh has none.
    pub tangent: Vec4,
    /// Both sets of texture coordinates.
    pub texture_coordinates: [Vec2; 2],
    /// Vertex colour, linear RGBA.
    pub color: Vec4,
    /// Instance that was hit.
    pub instance: u32,
}

/// Scene and ray caster.
pub struct World<C> {
    scene: Scene,
    substances: Vec<Substance>,
    /// By instance: how light under the surface is computed, where it is translucent.
    methods: Vec<Option<Method>>,
    placements: Vec<Placement>,
    /// World-space bounding box of each instance, m.
    bounds: Vec<(Vec3, Vec3)>,
    caster: C,
    /// Instances whose boundary lets paths inside, so that where a path is has to be tracked.
    enterable: Vec<u32>,
    /// By instance: bodies whose boundary may lie where its own does.
    neighbours: Vec<Box<[u32]>>,
    has_partial_coverage: bool,
    /// By instance: what is wrong with the mesh of a translucent body.
    flaws: Vec<(u32, Flaw)>,
    /// By instance: what has surfaces in a body, where it is worth while to know how far they are.
    surroundings: Vec<Option<Box<[u32]>>>,
}

impl<C: RayCaster> World<C> {
    /// Bakes `scene` and builds the ray caster with `build`. `methods` says by instance how light under the surface is
    /// computed, where it is translucent: paths enter those bodies that they walk in.
    pub fn new(
        mut scene: Scene,
        mut methods: Vec<Option<Method>>,
        build: impl FnOnce(&Geometry) -> Result<C, RaycastError>,
    ) -> Result<Self, RaycastError> {
        let mut substances: Vec<_> =
            scene.instances.iter().map(|i| Substance::Material(i.material)).collect();
        add_lights(&mut scene, &mut substances);
        methods.resize(substances.len(), None);
        bake(&mut scene);
        let bounds: Vec<_> = scene.instances.iter().map(|i| bounds_of(&scene, i)).collect();
        let flaws = flaws_of_bodies(&scene, &methods);
        let placements = (0..)
            .zip(&scene.instances)
            .map(|(index, instance)| {
                let inside_out = flaws.contains(&(index, Flaw::InsideOut));
                let positions = &scene.meshes[instance.mesh].positions;
                Placement::new(&instance.transform, positions, bounds[index as usize], inside_out)
            })
            .collect();
        let surroundings = surroundings(&scene, &substances, &methods, &bounds, &flaws);
        let enterable: Vec<u32> = (0..substances.len() as u32)
            .filter(|&i| match substances[i as usize] {
                Substance::Material(m) => {
                    interior_of(&scene, m, methods[i as usize] == Some(Method::Walk)).is_some()
                }
                Substance::Light(_) => false,
            })
            .collect();
        let is_walked = |instance: u32| methods[instance as usize] == Some(Method::Walk);
        let neighbours = neighbours(&enterable, is_walked, &bounds);
        let caster = {
            let meshes: Vec<_> = scene
                .meshes
                .iter()
                .map(|m| TriangleMesh { positions: &m.positions, triangles: &m.triangles })
                .collect();
            let instances: Vec<_> = scene
                .instances
                .iter()
                .zip(methods.iter().zip(&neighbours))
                .map(|(instance, (method, neighbours))| MeshInstance {
                    mesh: instance.mesh,
                    transform: instance.transform,
                    probed: *method == Some(Method::Bssrdf) || !neighbours.is_empty(),
                })
                .collect();
            build(&Geometry { meshes: &meshes, instances: &instances })?
        };
        let has_partial_coverage = scene.materials.iter().any(|m| m.coverage != Coverage::Full);
        Ok(Self {
            scene,
            substances,
            methods,
            placements,
            bounds,
            caster,
            enterable,
            neighbours,
            has_partial_coverage,
            flaws,
            surroundings,
        })
    }

    /// The scene, with geometry in world space where it is used once.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The ray caster.
    pub fn caster(&self) -> &C {
        &self.caster
    }

    /// What `instance` is made of.
    pub fn substance(&self, instance: u32) -> Substance {
        self.substances[instance as usize]
    }

    /// Instances and what they are made of.
    pub fn substances(&self) -> &[Substance] {
        &self.substances
    }

    /// Diameter of the bounding box of `instance`: no two of its points are farther apart, m.
    pub fn diameter(&self, instance: u32) -> f32 {
        let (low, high) = self.bounds(instance);
        (high - low).length()
    }

    /// Lowest and highest corner of the bounding box of `instance`, m.
    pub fn bounds(&self, instance: u32) -> (Vec3, Vec3) {
        self.bounds[instance as usize]
    }

    /// Radius of a sphere around all geometry, m; 1 if there is none.
    pub fn radius(&self) -> f32 {
        let join = |(a, b): (Vec3, Vec3), (low, high): &(Vec3, Vec3)| (a.min(*low), b.max(*high));
        let (low, high) = self.bounds.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), join);
        if low.x <= high.x { 0.5 * (high - low).length() } else { 1.0 }
    }

    /// True if some body lets paths inside.
    pub fn has_interiors(&self) -> bool {
        !self.enterable.is_empty()
    }

    /// Bodies whose boundary lets paths inside.
    pub fn enterable(&self) -> &[u32] {
        &self.enterable
    }

    /// Bodies whose boundary may lie where that of `instance` does, where paths walk in one of the two.
    pub fn neighbours(&self, instance: u32) -> &[u32] {
        &self.neighbours[instance as usize]
    }

    /// What is wrong with the meshes of translucent bodies.
    pub fn flaws(&self) -> &[(u32, Flaw)] {
        &self.flaws
    }

    /// What has surfaces in `instance`, its own among them, if it is a body so thick that it is worth while to know how far they are.
    pub fn surroundings(&self, instance: u32) -> Option<&[u32]> {
        self.surroundings[instance as usize].as_deref()
    }

    /// True if paths walk inside `instance`.
    pub fn is_walked(&self, instance: u32) -> bool {
        self.method(instance) == Some(Method::Walk)
    }

    /// True if paths walk inside some instance.
    pub fn has_walks(&self) -> bool {
        self.methods.contains(&Some(Method::Walk))
    }

    /// How light under the surface of `instance` is computed; `None` if it is not translucent.
    pub fn method(&self, instance: u32) -> Option<Method> {
        self.methods[instance as usize]
    }

    /// The methods of the instances of a material.
    pub fn methods_of(&self, material: usize) -> impl Iterator<Item = Method> {
        let instances = self.substances.iter().zip(&self.methods);
        instances
            .filter(move |(substance, _)| **substance == Substance::Material(material))
            .filter_map(|(_, method)| *method)
    }

    /// True if some material is not everywhere there.
    pub fn has_partial_coverage(&self) -> bool {
        self.has_partial_coverage
    }

    /// World-space corners of all triangles of an instance, in the winding that makes their normals point outward.
    pub fn triangles(&self, instance: u32) -> impl Iterator<Item = [Vec3; 3]> {
        let mesh = self.scene.instances[instance as usize].mesh;
        let count = self.scene.meshes[mesh].triangles.len() as u32;
        (0..count).map(move |primitive| self.triangle(instance, primitive))
    }

    /// World-space corners of a triangle, in the winding that makes its normal point outward.
    pub fn triangle(&self, instance: u32, primitive: u32) -> [Vec3; 3] {
        let [a, b, c] = self.corners(instance, primitive);
        if self.placements[instance as usize].mirrored { [a, c, b] } else { [a, b, c] }
    }

    /// World-space corners of a triangle in the order of its indices.
    fn corners(&self, instance: u32, primitive: u32) -> [Vec3; 3] {
        let placed = &self.scene.instances[instance as usize];
        let mesh = &self.scene.meshes[placed.mesh];
        let corners = mesh.triangles[primitive as usize].map(|v| mesh.positions[v as usize]);
        match self.placements[instance as usize].identity {
            true => corners,
            false => corners.map(|p| placed.transform.transform_point3(p)),
        }
    }

    /// Unit outward normal of the triangle that was hit.
    pub fn geometric_normal(&self, hit: &Hit) -> Vec3 {
        outward_normal(self.triangle(hit.instance, hit.primitive))
    }

    /// The point that was hit. What only textures need is looked up if `CAN` has them among its abilities.
    pub fn surface<const CAN: u32>(&self, hit: &Hit) -> SurfacePoint {
        let instance = &self.scene.instances[hit.instance as usize];
        let mesh = &self.scene.meshes[instance.mesh];
        let [i, j, k] = mesh.triangles[hit.primitive as usize].map(|v| v as usize);
        let (u, v) = (hit.u, hit.v);
        let w = 1.0 - u - v;
        let transform = &instance.transform;
        let [a, b, c] = self.corners(hit.instance, hit.primitive);
        let placed = self.placements[hit.instance as usize];
        let geometric_normal = outward_normal(if placed.mirrored { [a, c, b] } else { [a, b, c] });
        let mut shading_normal = geometric_normal;
        if !mesh.normals.is_empty() {
            let local = mesh.normals[i] * w + mesh.normals[j] * u + mesh.normals[k] * v;
            let local = if placed.identity { local } else { place_normal(transform, local) };
            let normal = local.normalize_or(geometric_normal);
            shading_normal = if normal.dot(geometric_normal) < 0.0 { -normal } else { normal };
        }
        let (mut tangent, mut texture_coordinates, mut color) = (Vec4::ZERO, [Vec2::ZERO; 2], Vec4::ONE);
        if const { Abilities::TEXTURES.are_in(CAN) } {
            if !mesh.tangents.is_empty() {
                let t = mesh.tangents[i] * w + mesh.tangents[j] * u + mesh.tangents[k] * v;
                tangent = place_vector(transform, t.truncate()).extend(mesh.tangents[i].w);
            }
            for (coordinates, set) in texture_coordinates.iter_mut().zip(&mesh.texture_coordinates) {
                if !set.is_empty() {
                    *coordinates = set[i] * w + set[j] * u + set[k] * v;
                }
            }
            if !mesh.colors.is_empty() {
                color = mesh.colors[i] * w + mesh.colors[j] * u + mesh.colors[k] * v;
            }
        }
        SurfacePoint {
            position: a * w + b * u + c * v,
            error: interpolation_error(a, b, c) + placed.error,
            geometric_normal,
            shading_normal,
            tangent,
            texture_coordinates,
            color,
            instance: hit.instance,
        }
    }

    /// The bodies that a point is inside of, found by following a ray from it to infinity: a closed body
    /// encloses the point if its first crossing leads out of it.
    pub fn interiors_at(&self, origin: Vec3, direction: Vec3) -> Interiors {
        let mut found = Interiors::default();
        let in_bounds = |instance: u32| {
            let (low, high) = self.bounds(instance);
            origin.cmpge(low).all() && origin.cmple(high).all()
        };
        let mut open = self.enterable.iter().filter(|&&i| in_bounds(i)).count();
        let mut left = Crossed::default();
        let mut ray = Ray::new(origin, direction);
        // Far more sheets than nested bodies have; a bound so that no geometry can hold the program.
        for _ in 0..256 {
            if open == 0 {
                break;
            }
            let Some(hit) = self.caster.closest(&ray) else { break };
            let interior = self.interior(hit.instance).filter(|_| in_bounds(hit.instance));
            if interior.is_some() && left.is_first(hit.instance) {
                open -= 1;
                if self.geometric_normal(&hit).dot(direction) > 0.0
                    && let Some(interior) = interior
                {
                    found.enter(interior);
                }
            }
            let point = self.surface::<{ Abilities::NONE.bits() }>(&hit);
            ray.origin = offset_from_surface(point.position, point.error, point.geometric_normal, direction);
        }
        found
    }

    /// What is inside `instance`, if paths go there; what scatters in it has to be filled in.
    pub fn interior(&self, instance: u32) -> Option<Interior> {
        let Substance::Material(material) = self.substance(instance) else { return None };
        let (ior, sigma_a) = interior_of(&self.scene, material, self.is_walked(instance))?;
        let diameter = self.diameter(instance);
        Some(Interior { instance, diameter, ior, medium: Medium::clear(sigma_a) })
    }
}

/// Instances that a ray has met.
#[derive(Default)]
struct Crossed {
    instances: [u32; 16],
    count: usize,
}

impl Crossed {
    /// True the first time it is asked about `instance`; false for any beyond the room for them.
    fn is_first(&mut self, instance: u32) -> bool {
        if self.count == self.instances.len() || self.instances[..self.count].contains(&instance) {
            return false;
        }
        self.instances[self.count] = instance;
        self.count += 1;
        true
    }
}

/// Gives every light that has a size a mesh, so that rays meet it.
fn add_lights(scene: &mut Scene, substances: &mut Vec<Substance>) {
    for (index, light) in scene.lights.iter().enumerate() {
        let Some(mesh) = light_mesh(light) else { continue };
        scene.instances.push(Instance {
            name: format!("light {index}"),
            mesh: scene.meshes.len(),
            // Not looked at: a light's substance is the light.
            material: 0,
            transform: Affine3A::IDENTITY,
        });
        scene.meshes.push(mesh);
        substances.push(Substance::Light(index));
    }
}

/// Transforms meshes that are placed once into world space, so that no ray has to.
fn bake(scene: &mut Scene) {
    let mut uses = vec![0_u32; scene.meshes.len()];
    for instance in &scene.instances {
        uses[instance.mesh] += 1;
    }
    for instance in &mut scene.instances {
        let transform = instance.transform;
        if uses[instance.mesh] != 1 || transform == Affine3A::IDENTITY {
            continue;
        }
        let mesh = &mut scene.meshes[instance.mesh];
        mesh.positions.iter_mut().for_each(|p| *p = place(&transform, *p));
        mesh.normals.iter_mut().for_each(|n| *n = place_normal(&transform, *n).normalize_or_zero());
        mesh.tangents.iter_mut().for_each(|t| *t = place_vector(&transform, t.truncate()).extend(t.w));
        if mirrors(&transform) {
            mesh.triangles.iter_mut().for_each(|t| t.swap(1, 2));
        }
        instance.transform = Affine3A::IDENTITY;
    }
}

/// An empty mesh has an empty box at the origin.
fn bounds_of(scene: &Scene, instance: &Instance) -> (Vec3, Vec3) {
    let positions = scene.meshes[instance.mesh].positions.iter().map(|p| place(&instance.transform, *p));
    positions
        .fold(None, |bounds: Option<(Vec3, Vec3)>, p| {
            let (low, high) = bounds.unwrap_or((p, p));
            Some((low.min(p), high.max(p)))
        })
        .unwrap_or_default()
}

/// In double precision, so that slivers keep a normal.
fn outward_normal([a, b, c]: [Vec3; 3]) -> Vec3 {
    (b - a).as_dvec3().cross((c - a).as_dvec3()).normalize_or(glam::DVec3::Z).as_vec3()
}

fn place(transform: &Affine3A, point: Vec3) -> Vec3 {
    transform.transform_point3(point)
}

fn place_vector(transform: &Affine3A, vector: Vec3) -> Vec3 {
    transform.transform_vector3(vector).normalize_or_zero()
}

/// Normals go with the inverse transpose, here the cofactors, which exist for every matrix; the sign of
/// the determinant keeps them outward under mirroring.
fn place_normal(transform: &Affine3A, normal: Vec3) -> Vec3 {
    let m = transform.matrix3;
    let cofactors =
        Mat3A::from_cols(m.y_axis.cross(m.z_axis), m.z_axis.cross(m.x_axis), m.x_axis.cross(m.y_axis));
    Vec3::from(cofactors * glam::Vec3A::from(normal)) * if mirrors(transform) { -1.0 } else { 1.0 }
}
