//! How a hierarchy is built: boxes are parted, and parts become nodes of eight children and leaves.

use arrayvec::ArrayVec;
use bytemuck::must_cast;

use super::bounds::Bounds;
use super::node::{Child, LANES, NODE_WORDS, Node, WIDTH, Word};
use super::pages::Arena;
use super::partition::{Cut, Item, Parted, Place, partition};
use crate::raycast::RaycastError;

/// Levels of nodes that traversals have room for. Halves of up to 2³² boxes need no more.
pub const DEPTH: usize = 36;

/// Levels after which boxes are parted without regard to where they are, so that heaps of them do not become chains.
const LEVELS: u32 = 64;

/// What has been built of a hierarchy.
#[derive(Clone, Copy)]
pub struct Built {
    pub root: Child,
    pub bounds: Bounds,
    /// What has been built over so many boxes.
    pub count: usize,
}

/// Appends to `arena` a hierarchy over `items`, of which there is at least one. `leaf` appends what is in at most `capacity` of them (no more than a block
/// has lanes), named by their numbers.
///
/// # Errors
/// If there is no memory, or it becomes too large for its indices.
pub fn build(
    arena: &mut Arena,
    items: &mut [Item],
    capacity: usize,
    mut leaf: impl FnMut(&mut Arena, &[u32]) -> Result<Child, RaycastError>,
) -> Result<Built, RaycastError> {
    let start = arena.words().len();
    for levels in [LEVELS, 0] {
        let parted = partition(items, capacity, levels)?;
        let mut collapse = Collapse { parted: &parted, capacity, depth: 0, arena: &mut *arena };
        let root = collapse.run(&mut leaf)?;
        if collapse.depth <= DEPTH {
            return Ok(Built { root, bounds: parted.bounds(parted.whole()), count: parted.whole().count });
        }
        arena.truncate(start);
    }
    Err(RaycastError::Hierarchy { message: format!("more than {DEPTH} levels") })
}

struct Collapse<'a> {
    parted: &'a Parted<'a>,
    capacity: usize,
    depth: usize,
    arena: &'a mut Arena,
}

/// Boxes that share a leaf.
struct Leaf {
    bounds: Bounds,
    boxes: ArrayVec<u32, LANES>,
}

impl Collapse<'_> {
    fn run(
        &mut self,
        leaf: &mut impl FnMut(&mut Arena, &[u32]) -> Result<Child, RaycastError>,
    ) -> Result<Child, RaycastError> {
        let whole = self.parted.whole();
        if self.parted.cut(whole, 1) == Cut::NONE {
            return leaf(self.arena, &self.leaf(whole).boxes);
        }
        let root = self.new_node()?;
        let mut stack = vec![(whole, root, 1)];
        while let Some((part, target, level)) = stack.pop() {
            self.depth = self.depth.max(level);
            let (leaves, inner) = self.children(part);
            let mut children = ArrayVec::<_, WIDTH>::new();
            for boxes in &leaves {
                children.push((boxes.bounds, leaf(self.arena, &boxes.boxes)?));
            }
            for part in inner {
                let word = self.new_node()?;
                children.push((self.parted.bounds(part), Child::node(word)));
                stack.push((part, word, level + 1));
            }
            let node = Node::new(&children);
            let place: [Word; NODE_WORDS] = must_cast(node);
            self.arena.words_mut()[target..target + NODE_WORDS].copy_from_slice(&place);
        }
        Ok(Child::node(root))
    }

    fn new_node(&mut self) -> Result<usize, RaycastError> {
        self.arena.push(&[0; NODE_WORDS])
    }

    /// What a part becomes the node of: leaves, and parts that are nodes again.
    fn children(&self, part: Place) -> (ArrayVec<Leaf, WIDTH>, ArrayVec<Place, WIDTH>) {
        let (mut leaves, mut inner) = (ArrayVec::new(), ArrayVec::new());
        let mut stack = ArrayVec::<(Place, Cut), { WIDTH + 1 }>::new();
        stack.push((part, self.parted.cut(part, 1)));
        while let Some((part, cut)) = stack.pop() {
            match cut.halves() {
                Some([left, right]) => {
                    let [first, second] = self.parted.halves(part);
                    stack.extend([(second, right), (first, left)].map(|(half, most)| {
                        // Of one child there is nothing to cut.
                        (half, if most > 1 { self.parted.cut(half, most) } else { Cut::NONE })
                    }))
                }
                None if self.parted.cut(part, 1) == Cut::NONE => leaves.push(self.leaf(part)),
                None => inner.push(part),
            }
        }
        merge(&mut leaves, self.capacity);
        (leaves, inner)
    }

    fn leaf(&self, part: Place) -> Leaf {
        let boxes = self.parted.items(part).iter().map(Item::index).collect();
        Leaf { bounds: self.parted.bounds(part), boxes }
    }
}

/// Merges leaves as long as that makes them cheaper: close to each other they overlap.
fn merge(leaves: &mut ArrayVec<Leaf, WIDTH>, capacity: usize) {
    loop {
        let mut best = (0.0, 0, 0);
        for i in 0..leaves.len() {
            for j in 0..i {
                let (a, b) = (&leaves[i], &leaves[j]);
                let saved =
                    a.bounds.half_area() + b.bounds.half_area() - a.bounds.union(b.bounds).half_area();
                if saved > best.0 && a.boxes.len() + b.boxes.len() <= capacity {
                    best = (saved, i, j);
                }
            }
        }
        let (saved, i, j) = best;
        if saved == 0.0 {
            return;
        }
        let Leaf { bounds, boxes } = leaves.swap_remove(i);
        leaves[j].bounds = leaves[j].bounds.union(bounds);
        leaves[j].boxes.extend(boxes);
    }
}
