//! What a hierarchy is made of: nodes of eight boxes and blocks of four triangles, one after the other in words of eight bytes.

use bytemuck::{Pod, Zeroable, must_cast_ref};
use glam::{Vec3, Vec3A};

use super::bounds::Bounds;

/// Children of a node.
pub const WIDTH: usize = 8;

/// Triangles of a block.
pub const LANES: usize = 4;

/// What places in a hierarchy are counted in. Nodes and blocks begin at every fourth, which is half a line of the processor's cache.
pub type Word = u64;

/// Words of a node.
pub const NODE_WORDS: usize = size_of::<Node>() / size_of::<Word>();

/// Words of a block.
pub const BLOCK_WORDS: usize = size_of::<TriangleBlock>() / size_of::<Word>();

/// The node that `child` names.
#[inline(always)]
pub fn node(words: &[Word], child: Child) -> &Node {
    // A node is named by its place alone.
    let start = child.0 as usize;
    let words = &words[start..start + NODE_WORDS];
    must_cast_ref::<[Word; NODE_WORDS], _>(words.try_into().expect("as many"))
}

/// The block that `child` names.
#[inline(always)]
pub fn block(words: &[Word], child: Child) -> &TriangleBlock {
    let start = child.word();
    let words = &words[start..start + BLOCK_WORDS];
    must_cast_ref::<[Word; BLOCK_WORDS], _>(words.try_into().expect("as many"))
}

/// Eight boxes and what is in them.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub struct Node {
    /// The lowest corner of all boxes.
    pub corner: [f32; 3],
    /// What walls are counted in: a power of two.
    pub step: f32,
    /// By axis: lower and upper walls, in steps from the corner.
    pub walls: [[[u8; WIDTH]; 2]; 3],
    /// What is in the boxes.
    pub children: [Child; WIDTH],
}

/// What is in a box: a node, a block or an instance. The two lowest bits say which; places are multiples of four.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(transparent)]
pub struct Child(pub u32);

impl Child {
    const LEAF: u32 = 1;
    const INSTANCE: u32 = 2;

    /// Words that there may be in a hierarchy.
    pub const LIMIT: usize = 1 << 32;

    /// The node that begins at `word`.
    pub fn node(word: usize) -> Self {
        Self(word as u32)
    }

    /// The block that every hierarchy begins with, in which there is nothing: so a ray that is not a number, which may seem to enter boxes that
    /// are not there, comes to an end.
    pub const NOTHING: Self = Self::block(0);

    /// No child: what is left of a walk that is over.
    pub const END: Self = Self(u32::MAX);

    /// The block that begins at `word`.
    pub const fn block(word: usize) -> Self {
        Self(word as u32 | Self::LEAF)
    }

    /// A placed mesh, by number.
    pub fn instance(index: u32) -> Self {
        Self(index << 2 | Self::INSTANCE | Self::LEAF)
    }

    #[inline(always)]
    pub fn is_node(self) -> bool {
        self.0 & Self::LEAF == 0
    }

    /// The number of the instance, if it is one.
    #[inline(always)]
    pub fn as_instance(self) -> Option<u32> {
        (self.0 & Self::INSTANCE != 0).then_some(self.0 >> 2)
    }

    /// Where the node or block begins.
    #[inline(always)]
    pub fn word(self) -> usize {
        (self.0 & !(Self::LEAF | Self::INSTANCE)) as usize
    }
}

/// The least step: its products with what rays are made of are normal numbers.
const LEAST_STEP: f32 = f32::from_bits(27 << 23);

impl Node {
    /// A node of at most eight children, each within its bounds.
    pub fn new(children: &[(Bounds, Child)]) -> Self {
        let children = children.iter().map(|(bounds, child)| (within_limits(*bounds), *child));
        let Bounds { low, high } = children.clone().fold(Bounds::EMPTY, |all, (bounds, _)| all.union(bounds));
        let mut node = Self {
            corner: low.to_array(),
            step: step((high - low).max_element()),
            // What is not there ends before it begins.
            walls: [[[u8::MAX; WIDTH], [0; WIDTH]]; 3],
            children: [Child::NOTHING; WIDTH],
        };
        for (i, (Bounds { low, high }, child)) in children.enumerate() {
            for axis in 0..3 {
                node.walls[axis][0][i] = node.steps_below(axis, low[axis]);
                node.walls[axis][1][i] = node.steps_above(axis, high[axis]);
            }
            node.children[i] = child;
        }
        node
    }

    /// Its children and their boxes.
    pub fn contents(&self) -> impl Iterator<Item = (Bounds, Child)> {
        let corner = |which: usize, i: usize| {
            Vec3A::from_array([0, 1, 2].map(|axis| self.wall(axis, self.walls[axis][which][i])))
        };
        let there = |i: &usize| self.children[*i] != Child::NOTHING;
        (0..WIDTH)
            .filter(there)
            .map(move |i| (Bounds { low: corner(0, i), high: corner(1, i) }, self.children[i]))
    }

    /// Where the wall is that is so many steps from the corner.
    #[inline(always)]
    pub fn wall(&self, axis: usize, steps: u8) -> f32 {
        self.corner[axis] + f32::from(steps) * self.step
    }

    /// The most steps to a wall that is not above `x`.
    fn steps_below(&self, axis: usize, x: f32) -> u8 {
        let steps = ((x - self.corner[axis]) / self.step).floor() as u8;
        // Because of rounding.
        steps - u8::from(self.wall(axis, steps) > x)
    }

    /// The fewest steps to a wall that is not below `x`.
    fn steps_above(&self, axis: usize, x: f32) -> u8 {
        let steps = ((x - self.corner[axis]) / self.step).ceil() as u8;
        steps + u8::from(self.wall(axis, steps) < x)
    }
}

/// Walls beyond this, which far-off instances may have, would overflow with the rays. No visible triangle is there.
const LIMIT: Vec3A = Vec3A::splat(1e20);

/// With finite walls, even if `bounds` are not numbers.
fn within_limits(Bounds { low, high }: Bounds) -> Bounds {
    Bounds { low: low.max(-LIMIT).min(LIMIT), high: high.min(LIMIT).max(-LIMIT) }
}

/// The least power of two of which 254 reach as far: one more is for rounding.
fn step(extent: f32) -> f32 {
    f32::from_bits((extent / 254.0).max(LEAST_STEP).to_bits().next_multiple_of(1 << 23))
}

/// Up to four triangles.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub struct TriangleBlock {
    /// By corner and axis: the coordinates of each triangle.
    pub corners: [[[f32; LANES]; 3]; 3],
    /// Indices into their mesh.
    pub primitives: [u32; LANES],
}

impl TriangleBlock {
    /// A block of triangles that no ray meets.
    pub const EMPTY: Self = Self { corners: [[[f32::NAN; LANES]; 3]; 3], primitives: [u32::MAX; LANES] };

    /// Makes triangle `i` of the block the given one.
    pub fn set(&mut self, i: usize, corners: &[Vec3; 3], primitive: u32) {
        for (rows, corner) in self.corners.iter_mut().zip(corners) {
            for (row, coordinate) in rows.iter_mut().zip(corner.to_array()) {
                row[i] = coordinate;
            }
        }
        self.primitives[i] = primitive;
    }

    /// The corners of triangle `i`.
    pub fn triangle(&self, i: usize) -> [Vec3; 3] {
        self.corners.map(|[x, y, z]| Vec3::new(x[i], y[i], z[i]))
    }
}
