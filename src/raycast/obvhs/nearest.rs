//! Branch and bound for the nearest triangle: near boxes first, and none beyond what has been found.

use glam::Vec3;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::node::CwBvhNode;

use super::{MeshBvh, TRAVERSAL_STACK};
use crate::raycast::nearest::Nearest;

/// Children of a node.
const WIDTH: usize = 8;

/// Each level leaves at most all its children but the one that is gone into.
const STACK: usize = TRAVERSAL_STACK * WIDTH;

/// A box to be looked into.
#[derive(Clone, Copy, Default)]
struct Entry {
    /// Square of its distance from the point.
    squared: f32,
    /// Index of the node it is a child of.
    node: u32,
    child: u8,
}

impl MeshBvh {
    /// Offers `search` every triangle that can be the nearest.
    pub(super) fn nearest(&self, search: &mut Nearest) {
        if self.triangles.is_empty() {
            return;
        }
        let point = search.local_point();
        let mut stack = [Entry::default(); STACK];
        let mut count = push_children(&self.bvh, 0, point, search, &mut stack, 0);
        while count > 0 {
            count -= 1;
            let Entry { squared, node, child } = stack[count];
            if squared > search.radius_squared() {
                continue;
            }
            let (node, child) = (&self.bvh.nodes[node as usize], usize::from(child));
            if node.is_leaf(child) {
                let (first, number) = node.child_primitives(child);
                for triangle in &self.triangles[first as usize..(first + number) as usize] {
                    search.offer(triangle.corners);
                }
            } else {
                let index = node.child_node_index(child);
                count = push_children(&self.bvh, index, point, search, &mut stack, count);
            }
        }
    }
}

/// Puts the children of a node that are near enough on the stack of `count` entries, the nearest on top, and returns
/// how many are on it then.
fn push_children(
    bvh: &CwBvh,
    index: u32,
    point: Vec3,
    search: &Nearest,
    stack: &mut [Entry; STACK],
    count: usize,
) -> usize {
    let node = &bvh.nodes[index as usize];
    let squares = squared_distances(node, point);
    let mut end = count;
    for (child, squared) in (0..).zip(squares) {
        if node.is_child_empty(child) || squared > search.radius_squared() {
            continue;
        }
        let mut place = end;
        while place > count && stack[place - 1].squared < squared {
            stack[place] = stack[place - 1];
            place -= 1;
        }
        stack[place] = Entry { squared, node: index, child: child as u8 };
        end += 1;
    }
    end
}

/// Squares of the distances of a point from the boxes of a node's children; anything for those that do not exist.
fn squared_distances(node: &CwBvhNode, point: Vec3) -> [f32; WIDTH] {
    let offset = point - node.p;
    let scale = node.compute_extent();
    let add = |squares: [f32; WIDTH], low: &[u8; WIDTH], high: &[u8; WIDTH], offset: f32, scale: f32| {
        std::array::from_fn(|i| {
            let (below, above) = (f32::from(low[i]) * scale - offset, offset - f32::from(high[i]) * scale);
            let distance = below.max(above).max(0.0);
            squares[i] + distance * distance
        })
    };
    let squares = add([0.0; WIDTH], &node.child_min_x, &node.child_max_x, offset.x, scale.x);
    let squares = add(squares, &node.child_min_y, &node.child_max_y, offset.y, scale.y);
    add(squares, &node.child_min_z, &node.child_max_z, offset.z, scale.z)
}
