//! How a hierarchy is built: boxes are parted, and parts become nodes of eight children and leaves.

use arrayvec::ArrayVec;
use bytemuck::must_cast;

use super::bounds::Bounds;
use super::node::{Child, LANES, NODE_WORDS, Node, WIDTH, Word};
use super::pages::Arena;
use super::partition::{Cut, Item, Part, partition};
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
        let parts = partition(items, capacity, levels)?;
        let mut collapse = Collapse { parts: &parts, capacity, depth: 0, arena: &mut *arena };
        let root = collapse.run(&mut leaf)?;
        let depth = collapse.depth;
        if depth <= DEPTH {
            return Ok(Built { root, bounds: parts[0].bounds(), count: items.len() });
        }
        arena.truncate(start);
    }
    Err(RaycastError::Hierarchy { message: format!("more than {DEPTH} levels") })
}

struct Collapse<'a> {
    parts: &'a [Part],
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
        if self.parts[0].cuts[0] == Cut::NONE {
            let root = self.leaf(0);
            return leaf(self.arena, &root.boxes);
        }
        let root = self.new_node()?;
        let mut stack = vec![(0_u32, root, 1)];
        while let Some((part, target, level)) = stack.pop() {
            self.depth = self.depth.max(level);
            let (leaves, inner) = self.children(part);
            let mut children = ArrayVec::<_, WIDTH>::new();
            for boxes in &leaves {
                children.push((boxes.bounds, leaf(self.arena, &boxes.boxes)?));
            }
            for part in inner {
                let word = self.new_node()?;
                children.push((self.parts[part as usize].bounds(), Child::node(word)));
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
    fn children(&self, part: u32) -> (ArrayVec<Leaf, WIDTH>, ArrayVec<u32, WIDTH>) {
        let (mut leaves, mut inner) = (ArrayVec::new(), ArrayVec::new());
        let mut stack = ArrayVec::<(u32, Cut), { WIDTH + 1 }>::new();
        stack.push((part, self.parts[part as usize].cuts[0]));
        while let Some((part, cut)) = stack.pop() {
            let part_of = &self.parts[part as usize];
            let (first, cuts) = (part_of.first(), part_of.cuts);
            match cut.halves() {
                Some([left, right]) => {
                    stack.extend([(first + 1, right), (first, left)].map(|(half, most)| {
                        // Of one child there is nothing to cut.
                        (half, if most > 1 { self.parts[half as usize].cuts[most - 1] } else { Cut::NONE })
                    }))
                }
                None if cuts[0] == Cut::NONE => leaves.push(self.leaf(part)),
                None => inner.push(part),
            }
        }
        merge(&mut leaves, self.capacity);
        (leaves, inner)
    }

    fn leaf(&self, part: u32) -> Leaf {
        let mut leaf = Leaf { bounds: self.parts[part as usize].bounds(), boxes: ArrayVec::new() };
        let mut stack = ArrayVec::<u32, { LANES + 1 }>::new();
        stack.push(part);
        while let Some(part) = stack.pop() {
            let part = &self.parts[part as usize];
            let first = part.first();
            if part.count == 1 {
                leaf.boxes.push(first);
            } else {
                stack.extend([first + 1, first]);
            }
        }
        leaf
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
