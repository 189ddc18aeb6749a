//! What a hierarchy is made of: nodes of eight boxes and blocks of four triangles, one after the other in words of eight bytes.

use bytemuck::{Pod, Zeroable, must_cast_ref};
use glam::Vec3;

use super::partition::Bounds;

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
    let words = &words[child.0 as usize..][..NODE_WORDS];
    must_cast_ref::<[Word; NODE_WORDS], _>(words.try_into().expect("as many"))
}

/// The block that `child` names.
#[inline(always)]
pub fn block(words: &[Word], child: Child) -> &TriangleBlock {
    let words = &words[child.word()..][..BLOCK_WORDS];
    must_cast_ref::<[Word; BLOCK_WORDS], _>(words.try_into().expect("as many"))
}

/// Eight boxes and what is in them.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub struct Node {
    /// By axis: lower and upper walls.
    pub walls: [[[f32; WIDTH]; 2]; 3],
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

impl Node {
    /// A node without children: no ray enters such boxes.
    pub const EMPTY: Self = Self {
        walls: [[[f32::INFINITY; WIDTH], [f32::NEG_INFINITY; WIDTH]]; 3],
        children: [Child::NOTHING; WIDTH],
    };

    /// Puts `child`, which is within `bounds`, in place `i`.
    pub fn set(&mut self, i: usize, Bounds { low, high }: &Bounds, child: Child) {
        for axis in 0..3 {
            self.walls[axis][0][i] = low[axis];
            self.walls[axis][1][i] = high[axis];
        }
        self.children[i] = child;
    }
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
