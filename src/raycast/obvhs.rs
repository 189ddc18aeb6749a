//! Ray queries by the crate `obvhs` as it comes: the yardstick of what Rust has to offer.
//!
//! The hierarchy is the compressed wide one of the crate `obvhs` (Ylitie, Karras, Laine 2017), one for each
//! mesh, with one over the instances on top. The triangle test is watertight. Two traits of the
//! crate's node test are worked around here:
//!
//! * It skips boxes that end before t = 10⁻⁴. Nodes are therefore given a ray whose parameter runs 2⁴⁰ times as
//!   fast (`NODE_SPEED`), measured along the longest axis.
//! * It does not round outwards. Boxes are therefore padded (`padded`).
//!
//! Triangles with coordinates that are not finite or beyond 10¹³ are invisible to this backend.

mod nearest;

use std::time::{Duration, Instant};

use glam::{Affine3A, Vec3, Vec3A};
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::bvh2_to_cwbvh::bvh2_to_cwbvh;
use obvhs::ploc::PlocBuilder;
use obvhs::ray::{Ray as NodeRay, RayHit};

use super::nearest::{Nearest, ObjectSpace};
use super::watertight::WatertightRay;
use super::{DistanceQuery, Geometry, Hit, Ray, RayCaster, RaycastError};

/// How much faster the parameter of the rays that nodes are tested with runs.
const NODE_SPEED: f32 = (1_u64 << 40) as f32;

/// Levels that the stack of `obvhs` has room for.
const TRAVERSAL_STACK: usize = 32;

/// Coordinates beyond this would overflow with [`NODE_SPEED`].
const LARGEST_COORDINATE: f32 = 1e13;

/// The pure-Rust backend.
pub struct ObvhsCaster {
    /// Over the boxes of the instances in `placements`.
    top: CwBvh,
    placements: Vec<Placement>,
    /// For each instance of the geometry its place in `placements`, if it has triangles.
    placement_of: Vec<Option<usize>>,
    meshes: Vec<MeshBvh>,
    build_time: Duration,
}

struct Placement {
    instance: u32,
    /// Index into `ObvhsCaster::meshes`.
    mesh: usize,
    /// `None` if the mesh lies in world space.
    space: Option<ObjectSpace>,
}

/// The triangles of a mesh in the order of the leaves.
struct MeshBvh {
    bvh: CwBvh,
    triangles: Vec<Triangle>,
}

struct Triangle {
    corners: [Vec3; 3],
    primitive: u32,
}

impl ObvhsCaster {
    /// Builds the hierarchies.
    ///
    /// # Errors
    /// If an index of `geometry` is out of range, or a hierarchy gets too deep (only for pathological
    /// input).
    pub fn new(geometry: &Geometry) -> Result<Self, RaycastError> {
        geometry.validate()?;
        let start = Instant::now();
        let mut uses = vec![0_usize; geometry.meshes.len()];
        geometry.instances.iter().for_each(|instance| uses[instance.mesh] += 1);

        let mut meshes = vec![];
        let mut shared = vec![None; geometry.meshes.len()];
        let (mut placements, mut boxes, mut placement_of) = (vec![], vec![], vec![]);
        for (id, instance) in (0..).zip(geometry.instances) {
            let baked = uses[instance.mesh] == 1;
            let mesh = match shared[instance.mesh] {
                Some(mesh) => mesh,
                None => {
                    let transform = if baked { instance.transform } else { Affine3A::IDENTITY };
                    meshes.push(MeshBvh::new(&geometry.meshes[instance.mesh], &transform)?);
                    meshes.len() - 1
                }
            };
            shared[instance.mesh] = Some(mesh);
            let bounds = meshes[mesh].bounds();
            placement_of.push(bounds.map(|_| placements.len()));
            let Some(bounds) = bounds else { continue };
            let space = (!baked).then(|| ObjectSpace::new(&instance.transform));
            boxes.push(if baked { bounds } else { transformed(&bounds, &instance.transform) });
            placements.push(Placement { instance: id, mesh, space });
        }
        let top = build(&boxes)?;
        Ok(Self { top, placements, placement_of, meshes, build_time: start.elapsed() })
    }

    /// How long [`ObvhsCaster::new`] took.
    pub fn build_time(&self) -> Duration {
        self.build_time
    }

    /// Bytes held by the hierarchies and the copy of the triangles.
    pub fn bytes(&self) -> usize {
        let hierarchy = |bvh: &CwBvh| size_of_val(&bvh.nodes[..]) + size_of_val(&bvh.primitive_indices[..]);
        let mesh = |mesh: &MeshBvh| hierarchy(&mesh.bvh) + size_of_val(&mesh.triangles[..]);
        hierarchy(&self.top) + self.meshes.iter().map(mesh).sum::<usize>()
    }

    fn placement(&self, top_index: usize) -> &Placement {
        &self.placements[self.top.primitive_indices[top_index] as usize]
    }
}

impl RayCaster for ObvhsCaster {
    fn closest(&self, ray: &Ray) -> Option<Hit> {
        let mut nearest = None;
        let mut rest = *ray;
        let (nodes, speed) = node_ray(ray);
        self.top.ray_traverse(nodes, &mut RayHit::none(), |_, index| {
            let placement = self.placement(index);
            let hit = self.meshes[placement.mesh].closest(&placement.to_object(&rest), placement.instance);
            let Some(hit) = hit else { return f32::INFINITY };
            nearest = Some(hit);
            rest.t_max = hit.t;
            hit.t * speed
        });
        nearest
    }

    fn occluded(&self, ray: &Ray) -> bool {
        let (nodes, _) = node_ray(ray);
        !self.top.ray_traverse_miss(nodes, |_, index| {
            let placement = self.placement(index);
            let occluded = self.meshes[placement.mesh].occluded(&placement.to_object(ray));
            if occluded { f32::NEG_INFINITY } else { f32::INFINITY }
        })
    }

    fn all_hits(&self, ray: &Ray, instance: u32, hits: &mut Vec<Hit>) {
        hits.clear();
        if let Some(Some(placement)) = self.placement_of.get(instance as usize) {
            let placement = &self.placements[*placement];
            self.meshes[placement.mesh].all_hits(&placement.to_object(ray), instance, hits);
        }
    }

    fn distance_to_nearest(&self, query: &DistanceQuery, instance: u32) -> f32 {
        let placement = self.placement_of.get(instance as usize).copied().flatten();
        let placement = placement.map(|index| &self.placements[index]);
        let mut search = Nearest::new(query, placement.and_then(|placement| placement.space.as_ref()));
        if let Some(placement) = placement {
            self.meshes[placement.mesh].nearest(&mut search);
        }
        search.lower_bound()
    }
}

impl Placement {
    fn to_object(&self, ray: &Ray) -> Ray {
        self.space.as_ref().map_or(*ray, |space| ray.transformed(&space.to_object))
    }
}

impl MeshBvh {
    fn new(mesh: &super::TriangleMesh, transform: &Affine3A) -> Result<Self, RaycastError> {
        let place = |index: u32| transform.transform_point3(mesh.positions[index as usize]);
        let visible = |triangle: &Triangle| {
            // Not `any(|x| x > …)`: a comparison with NaN must refuse.
            triangle.corners.iter().all(|corner| corner.abs().cmple(Vec3::splat(LARGEST_COORDINATE)).all())
        };
        let triangles = (0..).zip(mesh.triangles);
        let triangles =
            triangles.map(|(primitive, indices)| Triangle { corners: indices.map(place), primitive });
        let mut triangles: Vec<_> = triangles.filter(visible).map(Some).collect();
        let bounds = |triangle: &Triangle| Aabb::from_points(&triangle.corners.map(Vec3A::from));
        let boxes: Vec<_> = triangles.iter().flatten().map(bounds).collect();
        let bvh = build(&boxes)?;
        let in_leaf_order =
            bvh.primitive_indices.iter().filter_map(|&index| triangles[index as usize].take());
        let triangles = in_leaf_order.collect();
        Ok(Self { bvh, triangles })
    }

    fn bounds(&self) -> Option<Aabb> {
        (!self.triangles.is_empty()).then_some(self.bvh.total_aabb)
    }

    fn closest(&self, ray: &Ray, instance: u32) -> Option<Hit> {
        let mut nearest = None;
        let mut t_max = ray.t_max;
        let watertight = WatertightRay::new(ray);
        let (nodes, speed) = node_ray(ray);
        self.bvh.ray_traverse(nodes, &mut RayHit::none(), |_, index| {
            let Triangle { corners, primitive } = &self.triangles[index];
            let Some((t, u, v)) = watertight.intersect(corners, t_max) else { return f32::INFINITY };
            nearest = Some(Hit { t, u, v, instance, primitive: *primitive });
            t_max = t;
            t * speed
        });
        nearest
    }

    fn occluded(&self, ray: &Ray) -> bool {
        let watertight = WatertightRay::new(ray);
        let (nodes, _) = node_ray(ray);
        !self.bvh.ray_traverse_miss(nodes, |_, index| {
            let hit = watertight.intersect(&self.triangles[index].corners, ray.t_max);
            if hit.is_some() { f32::NEG_INFINITY } else { f32::INFINITY }
        })
    }

    fn all_hits(&self, ray: &Ray, instance: u32, hits: &mut Vec<Hit>) {
        let watertight = WatertightRay::new(ray);
        let (nodes, _) = node_ray(ray);
        self.bvh.ray_traverse_anyhit(nodes, |_, index| {
            let Triangle { corners, primitive } = &self.triangles[index];
            if let Some((t, u, v)) = watertight.intersect(corners, ray.t_max) {
                hits.push(Hit { t, u, v, instance, primitive: *primitive });
            }
        });
        hits.sort_unstable_by_key(|hit| hit.primitive);
    }
}

/// The ray that nodes are tested with, and how many times as fast its parameter runs as that of `ray`.
fn node_ray(ray: &Ray) -> (NodeRay, f32) {
    let direction = Vec3A::from(ray.direction);
    let longest = direction.abs().max_element();
    // A component of zero would give 0·∞ in the slab test. Against the longest one, 2⁻⁴⁰ is as good.
    let least = longest / NODE_SPEED;
    let magnitude = direction.abs().max(Vec3A::splat(least)) / longest;
    let inv_direction = NODE_SPEED / magnitude.copysign(direction);
    let speed = NODE_SPEED * longest;
    let origin = Vec3A::from(ray.origin);
    (NodeRay { origin, direction, inv_direction, tmin: 0.0, tmax: ray.t_max * speed }, speed)
}

/// The box around the image of `bounds`.
fn transformed(bounds: &Aabb, transform: &Affine3A) -> Aabb {
    let corner = |index: usize| {
        let pick = |axis: usize| if index >> axis & 1 == 0 { bounds.min[axis] } else { bounds.max[axis] };
        transform.transform_point3a(Vec3A::new(pick(0), pick(1), pick(2)))
    };
    Aabb::from_points(&std::array::from_fn::<_, 8, _>(corner))
}

/// The hierarchy over `boxes`, whose leaves hold indices into them.
fn build(boxes: &[Aabb]) -> Result<CwBvh, RaycastError> {
    if boxes.is_empty() {
        return Ok(CwBvh::default());
    }
    // More than the first padding is needed by thousands of equal triangles only.
    for padding in [8.0 * f32::EPSILON, 1e-3] {
        let bvh = build_padded(&padded(boxes, padding));
        if depth(&bvh) < TRAVERSAL_STACK {
            return Ok(bvh);
        }
    }
    let message = "the hierarchy is deeper than the traversal stack".to_string();
    Err(RaycastError::Library { library: "obvhs", message })
}

/// Moves the walls of all boxes outwards by at least `padding` times the largest coordinate. At 16 roundings, a
/// slab test rounds half as often, relative to the distance from the origin of the ray to the far side of a
/// node. That covers rays from anywhere in the scene; a camera further away may lose a hit at the
/// outline of a box.
///
/// Each box is also shifted a little of its own, because the builder pairs boxes by the size of their union and
/// strings equal ones up to a hierarchy that is as deep as they are many.
fn padded(boxes: &[Aabb], padding: f32) -> Vec<Aabb> {
    let largest = |bounds: &Aabb| bounds.min.abs().max(bounds.max.abs()).max_element();
    let least = padding * boxes.iter().map(largest).fold(0.0, f32::max);
    let pad = |(index, bounds): (u32, &Aabb)| {
        let jitter = index.wrapping_mul(0x9e37_79b9) as f32 / u32::MAX as f32;
        let [below, above] = [jitter, 1.0 - jitter].map(|part| Vec3A::splat(least * (1.0 + part)));
        Aabb::new(bounds.min - below, bounds.max + above)
    };
    (0..).zip(boxes).map(pad).collect()
}

fn build_padded(boxes: &[Aabb]) -> CwBvh {
    let presets = BvhBuildParams::medium_build();
    let mut binary = PlocBuilder::with_capacity(boxes.len()).build(
        presets.ploc_search_distance,
        boxes,
        (0..boxes.len() as u32).collect(),
        presets.sort_precision,
        presets.search_depth_threshold,
    );
    ReinsertionOptimizer::default().run(&mut binary, presets.reinsertion_batch_ratio, None);
    bvh2_to_cwbvh(&binary, presets.max_prims_per_leaf.min(3), true, false)
}

/// Levels of nodes.
fn depth(bvh: &CwBvh) -> usize {
    let mut level = vec![0_usize];
    let mut levels = 0;
    while !level.is_empty() {
        let children = |&index: &usize| {
            let node = &bvh.nodes[index];
            (0..node.imask.count_ones()).map(move |child| (node.child_base_idx + child) as usize)
        };
        level = level.iter().flat_map(children).collect();
        levels += 1;
    }
    levels
}
