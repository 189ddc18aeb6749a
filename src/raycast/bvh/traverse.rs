//! The traversals: to the nearest hit, and through all that a ray meets.

use std::cell::Cell;
use std::hint::{black_box, select_unpredictable};

use bytemuck::must_cast_mut;

use super::bounds::Bounds;
use super::build::{Built, DEPTH};
use super::kernel::{Entry, Kernel, entry};
use super::node::{Child, Node, WIDTH, Word, node};

/// Levels of the hierarchy over placements and of one below it.
const LEVELS: usize = 2 * DEPTH;

/// Entries that there is room for: a power of two, so that the remainder names a place for certain. Each level leaves at most all its children but the
/// one that is gone into, and at the bottom of each of two walks is its end.
const ROOM: usize = 1024;
const _: () = assert!((LEVELS + 1) * WIDTH <= ROOM);

/// Where walks keep what is left to be looked into: a stack. Eight entries are written at once.
pub type Room = [Entry; ROOM + WIDTH];

/// The same for children without where they are entered: the stack in the first half, blocks that are put aside in the second.
type ChildRoom = [Child; 2 * (ROOM + WIDTH)];

/// The most blocks that can be put aside.
pub const MOST_ASIDE: usize = ROOM - WIDTH;

thread_local! {
    /// To clear as much for each ray would take longer than many rays do.
    static SPARE: Cell<Option<Box<Room>>> = const { Cell::new(None) };
}

/// Calls `search` with room in which there may be anything.
#[inline(always)]
pub fn with_room<R>(search: impl FnOnce(&mut Room) -> R) -> R {
    let mut room = SPARE.take().unwrap_or_else(|| Box::new([0; ROOM + WIDTH]));
    let answer = search(&mut room);
    SPARE.set(Some(room));
    answer
}

/// Part of a hierarchy.
#[derive(Clone, Copy)]
pub struct Subtree {
    pub root: Child,
    pub bounds: Bounds,
    /// The largest coordinate in it.
    pub largest: f32,
    /// Boxes in it.
    pub count: usize,
}

impl Subtree {
    pub fn new(Built { root, bounds, count }: Built) -> Self {
        let largest = bounds.low.abs().max(bounds.high.abs()).max_element();
        Self { root, bounds, largest, count }
    }
}

/// A walk of a ray through the boxes of a hierarchy, near ones first.
pub struct Traversal<'a, K: Kernel> {
    words: &'a [Word],
    ray: &'a K::Boxes,
    /// See [`NodeRay::first`](super::prepared::NodeRay::first).
    first: [usize; 3],
    /// What is left, above the end.
    room: &'a mut Room,
    length: usize,
}

impl<'a, K: Kernel> Traversal<'a, K> {
    /// Begins at `root`, and leaves alone what is below `bottom` of the room.
    #[inline(always)]
    pub fn new(
        words: &'a [Word],
        (boxes, first): (&'a K::Boxes, [usize; 3]),
        root: Child,
        room: &'a mut Room,
        bottom: usize,
    ) -> Self {
        let start = bottom % ROOM;
        room[start..start + 2].copy_from_slice(&[entry(0.0, Child::END), entry(0.0, root)]);
        // A compiler that knows that all numbers of a vector are equal computes with one and copies it afterwards, which takes longer.
        Self { words, ray: black_box(boxes), first, room, length: start + 2 }
    }

    /// The room, and how much of it is in use.
    #[inline(always)]
    pub fn room(&mut self) -> (&mut Room, usize) {
        (self.room, self.length)
    }

    /// The nearest block or instance left that the ray may enter before `t_max`.
    #[inline(always)]
    pub fn next_leaf(&mut self, t_max: f32) -> Option<Child> {
        let mut child = self.pop(t_max);
        while child.is_node() {
            let node = node(self.words, child);
            let (mask, near) = K::enter(self.ray, &self.first, node, t_max);
            if mask == 0 {
                child = self.pop(t_max);
                continue;
            }
            let first = mask.trailing_zeros() as usize % WIDTH;
            let rest = mask & (mask - 1);
            child = node.children[first];
            if rest == 0 {
                continue;
            }
            let second = rest.trailing_zeros() as usize % WIDTH;
            if rest & (rest - 1) == 0 {
                let (a, b) = (entry(near[first], child), entry(near[second], node.children[second]));
                self.room[self.length % ROOM] = a.max(b);
                self.length += 1;
                K::prefetch(self.words, Child(a.max(b) as u32));
                child = Child(a.min(b) as u32);
                continue;
            }
            // The others in no order: most are never looked into.
            let nearest = K::nearest(&near) % WIDTH;
            child = node.children[nearest];
            self.push(node, mask & !(1 << nearest), &near);
        }
        (child != Child::END).then_some(child)
    }

    /// The uppermost child on the stack that is entered before `t_max`, or the end.
    #[inline(always)]
    fn pop(&mut self, t_max: f32) -> Child {
        let last = entry(t_max, Child::END);
        loop {
            self.length -= 1;
            let next = self.room[self.length % ROOM];
            if next <= last {
                return Child(next as u32);
            }
        }
    }

    /// Puts the children in `mask` on the stack.
    #[inline(always)]
    fn push(&mut self, node: &Node, mask: u32, near: &[f32; WIDTH]) {
        let start = self.length % ROOM;
        self.room[start..start + WIDTH].copy_from_slice(&K::gather(node, mask, near));
        self.length += mask.count_ones() as usize;
        K::prefetch(self.words, Child(self.room[(self.length - 1) % ROOM] as u32));
    }
}

/// A walk of a ray through all boxes that it enters, in no order.
pub struct Sweep<'a, K: Kernel> {
    words: &'a [Word],
    ray: &'a K::Boxes,
    first: [usize; 3],
    t_max: f32,
    /// What is left, above the end.
    room: &'a mut Room,
    length: usize,
}

impl<'a, K: Kernel> Sweep<'a, K> {
    /// Begins at `root`, and leaves alone what is below `bottom` of the room.
    #[inline(always)]
    pub fn new(
        words: &'a [Word],
        (boxes, first): (&'a K::Boxes, [usize; 3]),
        t_max: f32,
        root: Child,
        room: &'a mut Room,
        bottom: usize,
    ) -> Self {
        let start = 2 * (bottom % ROOM);
        let children: &mut ChildRoom = must_cast_mut(room);
        children[start..start + 3].copy_from_slice(&[Child::END, Child::END, root]);
        // See [`Traversal::new`].
        Self { words, ray: black_box(boxes), first, t_max, room, length: start + 3 }
    }

    /// The room, and how much of it is in use.
    #[inline(always)]
    pub fn room(&mut self) -> (&mut Room, usize) {
        (self.room, self.length.div_ceil(2))
    }

    /// The next block or instance that the ray may enter.
    #[inline(always)]
    pub fn next_leaf(&mut self) -> Option<Child> {
        let room: &mut ChildRoom = must_cast_mut(self.room);
        self.length -= 1;
        let mut child = room[self.length % (2 * ROOM)];
        while child.is_node() {
            let node = node(self.words, child);
            let (mask, _) = K::enter(self.ray, &self.first, node, self.t_max);
            // Without a branch for how many are entered, which could not be predicted.
            let last = room[(self.length - 1) % (2 * ROOM)];
            let start = self.length % (2 * ROOM);
            let rest = mask & mask.wrapping_sub(1);
            room[start..start + WIDTH].copy_from_slice(&K::pick(node, rest));
            let first = node.children[mask.trailing_zeros() as usize % WIDTH];
            child = select_unpredictable(mask == 0, last, first);
            self.length = self.length + mask.count_ones() as usize - 1;
            K::prefetch(self.words, room[(self.length - 1) % (2 * ROOM)]);
        }
        (child != Child::END).then_some(child)
    }

    /// True if `look` is for any block that the ray may enter; there are no instances. Blocks are put aside until there are `most` of them: they are
    /// fetched from memory in the meantime, and there is no branch for what a child is.
    #[inline(always)]
    pub fn any_block(mut self, most: usize, mut look: impl FnMut(Child) -> bool) -> bool {
        const ASIDE: usize = ROOM;
        let most = most.min(MOST_ASIDE);
        let room: &mut ChildRoom = must_cast_mut(self.room);
        self.length -= 1;
        let mut child = room[self.length % ROOM];
        if !child.is_node() {
            return look(child);
        }
        room[ASIDE - 1] = Child::NOTHING;
        let mut aside = ASIDE;
        while child.is_node() {
            let node = node(self.words, child);
            let (mask, _) = K::enter(self.ray, &self.first, node, self.t_max);

            let leaves = mask & K::leaves(node);
            let start = aside % (2 * ROOM);
            room[start..start + WIDTH].copy_from_slice(&K::pick(node, leaves));
            aside += leaves.count_ones() as usize;
            K::prefetch(self.words, room[(aside - 1) % (2 * ROOM)]);

            let nodes = mask & !leaves;
            let last = room[(self.length - 1) % ROOM];
            let rest = nodes & nodes.wrapping_sub(1);
            let start = self.length % ROOM;
            room[start..start + WIDTH].copy_from_slice(&K::pick(node, rest));
            let first = node.children[nodes.trailing_zeros() as usize % WIDTH];
            child = select_unpredictable(nodes == 0, last, first);
            self.length = self.length + nodes.count_ones() as usize - 1;
            K::prefetch(self.words, room[(self.length - 1) % ROOM]);

            if aside >= ASIDE + most {
                if room[ASIDE..aside % (2 * ROOM)].iter().any(|block| look(*block)) {
                    return true;
                }
                aside = ASIDE;
            }
        }
        room[ASIDE..aside % (2 * ROOM)].iter().any(|block| look(*block))
    }
}
