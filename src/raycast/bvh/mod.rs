//! Ray queries in Rust alone: the equal of Embree, and the way to build without it.
//!
//! Nodes have eight children, which are tested at once, as are the four triangles of a leaf. The walls of their boxes take a byte each: a ray that
//! strays through a large hierarchy spends most of its time waiting for memory. All of it lies in one arena: the triangles of
//! each mesh that is placed once, in the world; those of meshes that are placed several times, in their own space; and the
//! hierarchy over the placements. A traversal walks from one into the other without noticing, but for rays that change the
//! space. The triangle test is watertight, and boxes are tested with their walls moved outwards by more than all rounding.
//!
//! Triangles with coordinates that are not finite or beyond 10¹³ are invisible to this backend.

#[cfg(target_arch = "x86_64")]
mod avx2;
mod bounds;
mod build;
mod kernel;
mod nearest;
mod node;
mod pages;
mod partition;
mod prepared;
mod traverse;

use std::time::{Duration, Instant};

use bytemuck::must_cast;
use glam::{Affine3A, Vec3, Vec3A};

use self::bounds::Bounds;
use self::build::build;
use self::kernel::{Crossing, Kernel, Portable, Query};
use self::node::{BLOCK_WORDS, Child, LANES, TriangleBlock, WIDTH, Word, block, node};
use self::pages::{Arena, Pages};
use self::partition::Item;
use self::prepared::NodeRay;
use self::traverse::{MOST_ASIDE, Room, Subtree, Sweep, Traversal, with_room};
use super::nearest::{Nearest, ObjectSpace};
use super::watertight::WatertightRay;
use super::{DistanceQuery, Geometry, Hit, Ray, RayCaster, RaycastError, TriangleMesh};

/// Coordinates beyond this would overflow in the test of boxes.
const LARGEST_COORDINATE: f32 = 1e13;

/// More than hierarchies need as a rule: about 5.5 for blocks and 1 for nodes. Room that is not used takes no memory.
const WORDS_PER_TRIANGLE: usize = 12;

/// The pure-Rust backend.
pub struct BvhCaster {
    /// All nodes and blocks.
    arena: Arena,
    /// Over all placements; none if there is no triangle.
    world: Option<Subtree>,
    /// By instance of the geometry, if it has triangles.
    placements: Vec<Option<Placement>>,
    /// Some instances do not lie in the world.
    has_instances: bool,
    /// The instances that lie in the world: the first unit of each, and its number, in rising order.
    baked: Vec<(usize, u32)>,
    build_time: Duration,
    /// Without AVX2.
    is_portable: bool,
}

/// Triangles of an instance.
struct Placement {
    mesh: Subtree,
    /// None if they lie in the world.
    space: Option<ObjectSpace>,
}

impl Placement {
    fn to_object(&self, ray: &Ray) -> Ray {
        self.space.as_ref().map_or(*ray, |space| ray.transformed(&space.to_object))
    }
}

impl BvhCaster {
    /// Builds the hierarchies.
    ///
    /// # Errors
    /// If an index of `geometry` is out of range, or there are more triangles than indices.
    pub fn new(geometry: &Geometry) -> Result<Self, RaycastError> {
        geometry.validate()?;
        let start = Instant::now();
        let mut uses = vec![0_usize; geometry.meshes.len()];
        geometry.instances.iter().for_each(|instance| uses[instance.mesh] += 1);

        let triangles: usize = geometry.meshes.iter().map(|mesh| mesh.triangles.len()).sum();
        let mut arena = Arena::with_room(BLOCK_WORDS + WORDS_PER_TRIANGLE * triangles)?;
        push_block(&mut arena, TriangleBlock::EMPTY)?;
        let mut baked = vec![];
        let mut shared = vec![None; geometry.meshes.len()];
        let mut placements = Vec::with_capacity(geometry.instances.len());
        for (id, instance) in (0..).zip(geometry.instances) {
            let mesh = &geometry.meshes[instance.mesh];
            let is_baked = uses[instance.mesh] == 1;
            let subtree = match shared[instance.mesh] {
                Some(subtree) => subtree,
                None if is_baked => {
                    baked.push((arena.words().len(), id));
                    build_mesh(&mut arena, mesh, &instance.transform)?
                }
                None => build_mesh(&mut arena, mesh, &Affine3A::IDENTITY)?,
            };
            shared[instance.mesh] = Some(subtree);
            let space = (!is_baked).then(|| ObjectSpace::new(&instance.transform));
            placements.push(subtree.map(|mesh| Placement { mesh, space }));
        }
        let world = build_world(&mut arena, geometry, &placements)?;
        Ok(Self {
            has_instances: placements.iter().flatten().any(|placement| placement.space.is_some()),
            arena,
            world,
            placements,
            baked,
            build_time: start.elapsed(),
            #[cfg(target_arch = "x86_64")]
            is_portable: !avx2::is_available(),
            #[cfg(not(target_arch = "x86_64"))]
            is_portable: true,
        })
    }

    /// The same without instructions that not every processor has.
    pub fn portable(self) -> Self {
        Self { is_portable: true, ..self }
    }

    /// How long [`BvhCaster::new`] took.
    pub fn build_time(&self) -> Duration {
        self.build_time
    }

    /// Bytes held by the hierarchies, triangles included.
    pub fn bytes(&self) -> usize {
        size_of_val(self.arena.words())
    }

    /// The instance that a leaf is or, if it is a block, belongs to in the world.
    fn instance_of(&self, leaf: Child) -> u32 {
        leaf.as_instance().unwrap_or_else(|| {
            let after = self.baked.partition_point(|(first, _)| *first <= leaf.word());
            after.checked_sub(1).map_or(0, |last| self.baked[last].1)
        })
    }

    fn placement(&self, instance: u32) -> Option<&Placement> {
        self.placements.get(instance as usize)?.as_ref()
    }

    /// The nearest hit of an instance that does not lie in the world.
    fn closest_of<K: Kernel>(
        &self,
        ray: &Ray,
        instance: u32,
        (room, bottom): (&mut Room, usize),
    ) -> Option<Hit> {
        let placement = self.placement(instance)?;
        let ray = &placement.to_object(ray);
        K::answer(Closest::<false> { caster: self, ray, subtree: &placement.mesh, room, bottom })
    }

    fn is_occluded_by<K: Kernel>(
        &self,
        ray: &Ray,
        instance: u32,
        (room, bottom): (&mut Room, usize),
    ) -> bool {
        self.placement(instance).is_some_and(|placement| {
            let ray = &placement.to_object(ray);
            K::answer(Occluded::<false> { caster: self, ray, subtree: &placement.mesh, room, bottom })
        })
    }

    /// Answers by the best instructions that there are.
    #[inline]
    fn answer<Q: Query>(&self, query: Q) -> Q::Answer {
        #[cfg(target_arch = "x86_64")]
        if !self.is_portable {
            return avx2::Avx2::answer(query);
        }
        Portable::answer(query)
    }
}

impl RayCaster for BvhCaster {
    fn closest(&self, ray: &Ray) -> Option<Hit> {
        let subtree = self.world.as_ref()?;
        with_room(|room| match self.has_instances {
            true => self.answer(Closest::<true> { caster: self, ray, subtree, room, bottom: 0 }),
            false => self.answer(Closest::<false> { caster: self, ray, subtree, room, bottom: 0 }),
        })
    }

    fn occluded(&self, ray: &Ray) -> bool {
        let Some(subtree) = &self.world else { return false };
        with_room(|room| match self.has_instances {
            true => self.answer(Occluded::<true> { caster: self, ray, subtree, room, bottom: 0 }),
            false => self.answer(Occluded::<false> { caster: self, ray, subtree, room, bottom: 0 }),
        })
    }

    fn all_hits(&self, ray: &Ray, instance: u32, hits: &mut Vec<Hit>) {
        hits.clear();
        let Some(placement) = self.placement(instance) else { return };
        let ray = &placement.to_object(ray);
        let (words, subtree) = (self.arena.words(), &placement.mesh);
        with_room(|room| self.answer(AllHits { words, ray, subtree, instance, hits: &mut *hits, room }));
        hits.sort_unstable_by_key(|hit| hit.primitive);
    }

    fn distance_to_nearest(&self, query: &DistanceQuery, instance: u32) -> f32 {
        let placement = self.placement(instance);
        let mut search = Nearest::new(query, placement.and_then(|placement| placement.space.as_ref()));
        if let Some(placement) = placement {
            let (words, root) = (self.arena.words(), placement.mesh.root);
            with_room(|room| self.answer(nearest::Offer { words, root, search: &mut search, room }));
        }
        search.lower_bound()
    }
}

/// The nearest hit below `subtree`, in which there may be instances if `PLACED`: without them the loop has more registers for the rest.
struct Closest<'a, const PLACED: bool> {
    caster: &'a BvhCaster,
    ray: &'a Ray,
    subtree: &'a Subtree,
    room: &'a mut Room,
    /// How much of it is in use.
    bottom: usize,
}

impl<const PLACED: bool> Query for Closest<'_, PLACED> {
    type Answer = Option<Hit>;

    #[inline(always)]
    fn answer<K: Kernel>(self) -> Option<Hit> {
        let Self { caster, ray, subtree, room, bottom } = self;
        let boxes = NodeRay::new(ray, subtree.largest);
        let boxes = (&K::prepare(&boxes), boxes.first());
        let words = caster.arena.words();
        let mut traversal = Traversal::<K>::new(words, boxes, subtree.root, room, bottom);
        let mut t_max = ray.t_max;
        let mut nearest: Option<(Crossing, Child)> = None;
        let mut take = |crossing: Crossing, leaf: Child, t_max: &mut f32| {
            let order = |(crossing, leaf): (Crossing, Child)| (caster.instance_of(leaf), crossing.primitive);
            // Of equally near ones, the first in the scene.
            let is_first = crossing.t < *t_max
                || crossing.t == *t_max && nearest.is_none_or(|best| order((crossing, leaf)) < order(best));
            if is_first {
                *t_max = crossing.t;
                nearest = Some((crossing, leaf));
            }
        };
        let mut next = traversal.next_leaf(t_max);
        // Many rays end here: for these, nothing is prepared to meet triangles.
        next?;
        let triangles = WatertightRay::new(ray);
        while let Some(leaf) = next {
            if PLACED && let Some(instance) = leaf.as_instance() {
                let ray = Ray { t_max, ..*ray };
                if let Some(hit) = caster.closest_of::<K>(&ray, instance, traversal.room()) {
                    take(hit.into(), leaf, &mut t_max);
                }
            } else {
                let block = block(words, leaf);
                if let Some(crossings) = K::meet(&triangles, block, t_max) {
                    crossings.of(block).for_each(|crossing| take(crossing, leaf, &mut t_max));
                }
            }
            next = traversal.next_leaf(t_max);
        }
        nearest.map(|(crossing, leaf)| crossing.hit(caster.instance_of(leaf)))
    }
}

/// Whether there is a hit below `subtree`; `PLACED` as for [`Closest`].
struct Occluded<'a, const PLACED: bool> {
    caster: &'a BvhCaster,
    ray: &'a Ray,
    subtree: &'a Subtree,
    room: &'a mut Room,
    /// How much of it is in use.
    bottom: usize,
}

impl<const PLACED: bool> Query for Occluded<'_, PLACED> {
    type Answer = bool;

    #[inline(always)]
    fn answer<K: Kernel>(self) -> bool {
        let Self { caster, ray, subtree, room, bottom } = self;
        let boxes = NodeRay::new(ray, subtree.largest);
        let boxes = (&K::prepare(&boxes), boxes.first());
        let triangles = WatertightRay::new(ray);
        let words = caster.arena.words();
        let meets = |leaf: Child| K::meet(&triangles, block(words, leaf), ray.t_max).is_some();
        let mut sweep = Sweep::<K>::new(words, boxes, ray.t_max, subtree.root, room, bottom);
        if !PLACED {
            // Of more, most would be looked into in vain behind the one that is hit.
            return sweep.any_block(4, meets);
        }
        while let Some(leaf) = sweep.next_leaf() {
            let is_met = match leaf.as_instance() {
                Some(instance) => caster.is_occluded_by::<K>(ray, instance, sweep.room()),
                None => meets(leaf),
            };
            if is_met {
                return true;
            }
        }
        false
    }
}

/// Every crossing with the triangles of one instance.
struct AllHits<'a> {
    words: &'a [Word],
    ray: &'a Ray,
    subtree: &'a Subtree,
    instance: u32,
    hits: &'a mut Vec<Hit>,
    room: &'a mut Room,
}

impl Query for AllHits<'_> {
    type Answer = ();

    #[inline(always)]
    fn answer<K: Kernel>(self) {
        let Self { words, ray, subtree, instance, hits, room } = self;
        let boxes = NodeRay::new(ray, subtree.largest);
        let boxes = (&K::prepare(&boxes), boxes.first());
        let triangles = WatertightRay::new(ray);
        let sweep = Sweep::<K>::new(words, boxes, ray.t_max, subtree.root, room, 0);
        sweep.any_block(MOST_ASIDE, |child| {
            let block = block(words, child);
            if let Some(crossings) = K::meet(&triangles, block, ray.t_max) {
                crossings.of(block).for_each(|crossing| hits.push(crossing.hit(instance)));
            }
            false
        });
    }
}

/// Appends the visible triangles of a mesh to `arena`, if there are any.
fn build_mesh(
    arena: &mut Arena,
    mesh: &TriangleMesh,
    transform: &Affine3A,
) -> Result<Option<Subtree>, RaycastError> {
    let corners = |primitive: u32| {
        mesh.triangles[primitive as usize].map(|i| transform.transform_point3(mesh.positions[i as usize]))
    };
    // Not `any(|x| x > …)`: a comparison with NaN must refuse.
    let is_visible = |corner: &Vec3| corner.abs().cmple(Vec3::splat(LARGEST_COORDINATE)).all();
    let mut items: Pages<Item> = Pages::zeroed(mesh.triangles.len())?;
    let mut count = 0;
    for primitive in 0..mesh.triangles.len() as u32 {
        let corners = corners(primitive);
        if corners.iter().all(is_visible) {
            items[count] = Item::new(Bounds::around(corners.map(Vec3A::from)), primitive);
            count += 1;
        }
    }
    if count == 0 {
        return Ok(None);
    }
    let built = build(arena, &mut items[..count], LANES, |arena, primitives| {
        let mut block = TriangleBlock::EMPTY;
        for (lane, &primitive) in primitives.iter().enumerate() {
            block.set(lane, &corners(primitive), primitive);
        }
        push_block(arena, block)
    })?;
    Ok(Some(Subtree::new(built)))
}

fn push_block(arena: &mut Arena, block: TriangleBlock) -> Result<Child, RaycastError> {
    let words: [Word; BLOCK_WORDS] = must_cast(block);
    arena.push(&words).map(Child::block)
}

/// Appends the hierarchy over all placements. A single one that lies in the world is its own. Of a few, the one of most triangles is opened, so that rays
/// need not pass the boxes of all before its own (Benthin, Woop, Wald, Áfra 2017, "Improved two-level BVHs using partial re-braiding").
fn build_world(
    arena: &mut Arena,
    geometry: &Geometry,
    placements: &[Option<Placement>],
) -> Result<Option<Subtree>, RaycastError> {
    let mut placed = vec![];
    let mut most = None;
    for (id, (placement, instance)) in (0..).zip(placements.iter().zip(geometry.instances)) {
        let Some(Placement { mesh, space }) = placement else { continue };
        if space.is_none() && mesh.root.is_node() && most.is_none_or(|(_, count)| mesh.count > count) {
            most = Some((placed.len(), mesh.count));
        }
        placed.push(match space {
            None => (mesh.bounds, mesh.root),
            Some(_) => (mesh.bounds.transformed(&instance.transform), Child::instance(id)),
        });
    }
    if let Some((index, _)) = most
        && (2..WIDTH).contains(&placed.len())
    {
        let (_, root) = placed.swap_remove(index);
        placed.extend(node(arena.words(), root).contents());
    }
    let mut items: Vec<_> =
        (0..).zip(&placed).map(|(index, (bounds, _))| Item::new(*bounds, index)).collect();
    if items.is_empty() {
        return Ok(None);
    }
    let built = build(arena, &mut items, 1, |_, indices| Ok(placed[indices[0] as usize].1))?;
    Ok(Some(Subtree::new(built)))
}
