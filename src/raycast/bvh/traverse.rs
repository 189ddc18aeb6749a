//! The traversals: to the nearest hit, and through all that a ray meets.

use std::cell::RefCell;
use std::hint::black_box;

use super::bounds::Bounds;
use super::build::{Built, DEPTH};
use super::kernel::{Entry, Kernel, entry};
use super::node::{Child, Node, WIDTH, Word, node};

/// Levels of the hierarchy over placements and of one below it.
const LEVELS: usize = 2 * DEPTH;

/// Entries that may be left at once: each level leaves at most all its children but the one that is gone into, and there are written all eight
/// at once.
const ROOM: usize = (LEVELS + 1) * WIDTH;

thread_local! {
    /// Where traversals keep what is left to be looked into. To clear as much for each ray would take longer than many rays do.
    static STACK: RefCell<[Entry; ROOM]> = const { RefCell::new([0; ROOM]) };
}

/// Calls `search` with room for what a traversal leaves to be looked into, in which there may be anything.
pub fn with_room<R>(search: impl FnOnce(&mut [Entry]) -> R) -> R {
    STACK.with_borrow_mut(|room| search(room))
}

/// Part of a hierarchy.
#[derive(Clone, Copy)]
pub struct Subtree {
    pub root: Child,
    pub bounds: Bounds,
    /// The largest coordinate in it.
    pub largest: f32,
}

impl Subtree {
    pub fn new(Built { root, bounds, .. }: Built) -> Self {
        let largest = bounds.low.abs().max(bounds.high.abs()).max_element();
        Self { root, bounds, largest }
    }
}

/// A walk of a ray through the boxes of a hierarchy: down from a child to a leaf, then on from the next child on the stack.
pub struct Traversal<'a, K: Kernel> {
    words: &'a [Word],
    ray: &'a K::Boxes,
    /// The stack, as far as it reaches, and room for more.
    room: &'a mut [Entry],
    length: usize,
}

impl<'a, K: Kernel> Traversal<'a, K> {
    /// Begins with nothing on the stack.
    #[inline(always)]
    pub fn new(words: &'a [Word], ray: &'a K::Boxes, room: &'a mut [Entry]) -> Self {
        // A compiler that knows that all numbers of a vector are equal computes with one and copies it afterwards, which takes longer.
        Self { words, ray: black_box(ray), room, length: 0 }
    }

    /// What of the room is not used.
    #[inline(always)]
    pub fn rest(&mut self) -> &mut [Entry] {
        &mut self.room[self.length..]
    }

    /// The nearest block or instance below `child` that the ray may enter before `t_max`; the others are left on the stack,
    /// nearer ones above.
    #[inline(always)]
    pub fn nearest_leaf(&mut self, mut child: Child, t_max: f32) -> Option<Child> {
        while child.is_node() {
            let node = node(self.words, child);
            let (mask, near) = K::enter(self.ray, node, t_max);
            if mask == 0 {
                return None;
            }
            let first = mask.trailing_zeros() as usize & (WIDTH - 1);
            let rest = mask & (mask - 1);
            child = node.children[first];
            if rest == 0 {
                continue;
            }
            let second = rest.trailing_zeros() as usize & (WIDTH - 1);
            if rest & (rest - 1) == 0 {
                let other = node.children[second];
                self.prefetch(child);
                self.prefetch(other);
                let (a, b) = (entry(near[first], child), entry(near[second], other));
                self.room[self.length] = a.max(b);
                self.length += 1;
                child = Child(a.min(b) as u32);
                continue;
            }
            child = Child(sort(self.push_all(node, mask, &near)) as u32);
            self.length -= 1;
        }
        Some(child)
    }

    /// Some block or instance below `child` that the ray may enter before `t_max`; the others are left on the stack.
    #[inline(always)]
    pub fn any_leaf(&mut self, mut child: Child, t_max: f32) -> Option<Child> {
        while child.is_node() {
            let node = node(self.words, child);
            let (mask, near) = K::enter(self.ray, node, t_max);
            if mask == 0 {
                return None;
            }
            child = node.children[mask.trailing_zeros() as usize & (WIDTH - 1)];
            let rest = mask & (mask - 1);
            if rest != 0 {
                self.prefetch(child);
                self.push_all(node, rest, &near);
            }
        }
        Some(child)
    }

    /// The uppermost child on the stack that is entered before `t_max`.
    #[inline(always)]
    pub fn pop(&mut self, t_max: f32) -> Option<Child> {
        loop {
            self.length = self.length.checked_sub(1)?;
            let next = self.room[self.length];
            if f32::from_bits((next >> 32) as u32) <= t_max {
                return Some(Child(next as u32));
            }
        }
    }

    /// Puts the children in `mask` on the stack.
    #[inline(always)]
    fn push_all(&mut self, node: &Node, mask: u32, near: &[f32; WIDTH]) -> &mut [Entry] {
        let count = mask.count_ones() as usize;
        let place = &mut self.room[self.length..][..WIDTH];
        place.copy_from_slice(&K::gather(node, mask, near));
        self.length += count;
        let pushed = &mut place[..count & 0xf];
        for entry in &*pushed {
            K::prefetch(self.words, Child(*entry as u32));
        }
        pushed
    }

    #[inline(always)]
    fn prefetch(&self, child: Child) {
        K::prefetch(self.words, child);
    }
}

/// Sorts entries so that the nearest comes last, and returns that.
#[inline(always)]
fn sort(entries: &mut [Entry]) -> Entry {
    match entries {
        [a, b, c] => {
            exchange(a, b);
            exchange(b, c);
            exchange(a, b);
            *c
        }
        [a, b, c, d] => {
            exchange(a, b);
            exchange(c, d);
            exchange(a, c);
            exchange(b, d);
            exchange(b, c);
            *d
        }
        _ => {
            for i in 1..entries.len() {
                let new = entries[i];
                let mut place = i;
                while place > 0 && entries[place - 1] < new {
                    entries[place] = entries[place - 1];
                    place -= 1;
                }
                entries[place] = new;
            }
            entries.last().copied().unwrap_or_default()
        }
    }
}

/// Puts the farther one first.
#[inline(always)]
fn exchange(a: &mut Entry, b: &mut Entry) {
    (*a, *b) = ((*a).max(*b), (*a).min(*b));
}
