//! Branch and bound for the nearest triangle: near boxes first, and none beyond what has been found.

use glam::Vec3;

use super::kernel::{Entry, Kernel, Query, entry};
use super::node::{Child, LANES, Node, WIDTH, Word, block, node};
use crate::raycast::nearest::Nearest;

/// Offers `search` every triangle below `root` that can be the nearest.
pub struct Offer<'a, 'b> {
    pub words: &'a [Word],
    pub root: Child,
    pub search: &'a mut Nearest<'b>,
    pub room: &'a mut [Entry],
}

impl Query for Offer<'_, '_> {
    type Answer = ();

    #[inline(always)]
    fn answer<K: Kernel>(self) {
        let Self { words, root, search, room } = self;
        let point = search.local_point();
        room[0] = entry(0.0, root);
        let mut length = 1;
        while let Some(last) = usize::checked_sub(length, 1) {
            length = last;
            let next = room[last];
            if f32::from_bits((next >> 32) as u32) > search.radius_squared() {
                continue;
            }
            let child = Child(next as u32);
            if child.is_node() {
                length +=
                    push_children(node(words, child), point, search.radius_squared(), &mut room[last..]);
            } else {
                let block = block(words, child);
                (0..LANES).for_each(|i| {
                    search.offer(block.triangle(i));
                });
            }
        }
    }
}

/// Puts the children of a node that are near enough at the beginning of `room`, the nearest last, and says how many there are.
#[inline(always)]
fn push_children(node: &Node, point: Vec3, radius_squared: f32, room: &mut [Entry]) -> usize {
    let squares = squared_distances(node, point);
    let mut count = 0;
    for (squared, child) in squares.into_iter().zip(node.children) {
        if squared <= radius_squared {
            let new = entry(squared, child);
            let mut place = count;
            while place > 0 && room[place - 1] < new {
                room[place] = room[place - 1];
                place -= 1;
            }
            room[place] = new;
            count += 1;
        }
    }
    count
}

/// Squares of the distances of a point from the boxes of a node. What is said of one that is not there does not matter: nothing is in it.
#[inline(always)]
fn squared_distances(node: &Node, point: Vec3) -> [f32; WIDTH] {
    let mut squares = [0.0_f32; WIDTH];
    for (axis, [low, high]) in node.walls.iter().enumerate() {
        for i in 0..WIDTH {
            let (low, high) = (node.wall(axis, low[i]), node.wall(axis, high[i]));
            let distance = (low - point[axis]).max(point[axis] - high).max(0.0);
            squares[i] += distance * distance;
        }
    }
    squares
}
