//! The two tests that a traversal is made of, for eight boxes and for four triangles at once: by AVX2 where the processor has it, and
//! in plain Rust. Hits are the same bit for bit: boxes only decide what is looked at, and triangles are computed without fused
//! operations.

use super::node::{Child, LANES, Node, TriangleBlock, WIDTH, Word};
use super::prepared::NodeRay;
use crate::raycast::Hit;
use crate::raycast::watertight::WatertightRay;

/// A box to be looked into: where it is entered in the upper half, what is in it in the lower. As the parameter is not negative,
/// the nearer of two is the smaller.
pub type Entry = u64;

/// The entry of `child`, whose box is entered at `t`.
#[inline(always)]
pub fn entry(t: f32, child: Child) -> Entry {
    u64::from(t.to_bits()) << 32 | u64::from(child.0)
}

/// Where a ray meets the triangles of a block.
#[derive(Clone, Copy, Debug)]
pub struct Crossings {
    /// Which are met, by bits.
    pub mask: u32,
    /// By triangle: see [`Crossing`].
    pub t: [f32; LANES],
    pub weights: [[f32; LANES]; 2],
    pub determinant: [f32; LANES],
}

impl Crossings {
    /// None.
    pub const NONE: Self =
        Self { mask: 0, t: [0.0; LANES], weights: [[0.0; LANES]; 2], determinant: [1.0; LANES] };

    /// Each, of the triangles of `block`.
    #[inline(always)]
    pub fn of(&self, block: &TriangleBlock) -> impl Iterator<Item = Crossing> {
        let mut mask = self.mask;
        std::iter::from_fn(move || {
            let i = mask.trailing_zeros() as usize;
            mask &= mask.wrapping_sub(1);
            (i < LANES).then(|| Crossing {
                t: self.t[i],
                weights: [self.weights[0][i], self.weights[1][i]],
                determinant: self.determinant[i],
                primitive: block.primitives[i],
            })
        })
    }
}

/// Where a ray meets a triangle.
#[derive(Clone, Copy, Debug)]
pub struct Crossing {
    /// Ray parameter.
    pub t: f32,
    /// Barycentric coordinates of the second and the third corner, times the determinant.
    pub weights: [f32; 2],
    /// Not divided by before it is known whether the hit is wanted.
    pub determinant: f32,
    /// Index of the triangle in its mesh.
    pub primitive: u32,
}

impl Crossing {
    /// The hit of an instance.
    #[inline(always)]
    pub fn hit(self, instance: u32) -> Hit {
        let Self { t, weights, determinant, primitive } = self;
        let [u, v] = weights.map(|weight| weight / determinant);
        Hit { t, u, v, instance, primitive }
    }
}

impl From<Hit> for Crossing {
    fn from(Hit { t, u, v, primitive, .. }: Hit) -> Self {
        Self { t, weights: [u, v], determinant: 1.0, primitive }
    }
}

/// A question about rays or points.
pub trait Query {
    type Answer;

    /// Always inlined, so that it is compiled for the instructions of the kernel.
    fn answer<K: Kernel>(self) -> Self::Answer;
}

/// An implementation of the tests.
pub trait Kernel: Sized {
    /// A ray as this kernel tests boxes with it.
    type Boxes;

    /// The ray in that form.
    fn prepare(ray: &NodeRay) -> Self::Boxes;

    /// Which of the boxes of `node` the ray may enter before `t_max` (by bits), and where it enters each of them; others
    /// are farther than all numbers.
    /// `first`: see [`NodeRay::first`].
    fn enter(ray: &Self::Boxes, first: &[usize; 3], node: &Node, t_max: f32) -> (u32, [f32; WIDTH]);

    /// In which of its boxes there are blocks or instances, by bits.
    fn leaves(node: &Node) -> u32;

    /// The entries of the boxes in `mask`, first.
    fn gather(node: &Node, mask: u32, near: &[f32; WIDTH]) -> [Entry; WIDTH];

    /// The box that is entered first, if any is.
    fn nearest(near: &[f32; WIDTH]) -> usize;

    /// What is in the boxes in `mask`, first.
    fn pick(node: &Node, mask: u32) -> [Child; WIDTH];

    /// Where the ray meets the triangles of `block`, with t in (0, `t_max`], if it meets any.
    fn meet(ray: &WatertightRay, block: &TriangleBlock, t_max: f32) -> Option<Crossings>;

    /// Answers `query`, all of it compiled for these instructions.
    fn answer<Q: Query>(query: Q) -> Q::Answer;

    /// Has the node or block fetched that will be looked at soon.
    fn prefetch(words: &[Word], child: Child);
}

/// In plain Rust.
pub struct Portable;

impl Kernel for Portable {
    type Boxes = NodeRay;

    #[inline(always)]
    fn prepare(ray: &NodeRay) -> NodeRay {
        *ray
    }

    #[inline(always)]
    fn enter(ray: &NodeRay, first: &[usize; 3], node: &Node, t_max: f32) -> (u32, [f32; WIDTH]) {
        let mut near = [0.0_f32; WIDTH];
        let mut far = [t_max; WIDTH];
        for axis in 0..3 {
            let first = first[axis] % 2;
            let (first, last) = (&node.walls[axis][first], &node.walls[axis][first ^ 1]);
            let step = node.step * ray.inverse[axis];
            let at = |which: usize| node.corner[axis] * ray.inverse[axis] + ray.offsets[which][axis];
            let (start, end) = (at(0), at(1));
            for i in 0..WIDTH {
                near[i] = near[i].max(f32::from(first[i]) * step + start);
                far[i] = far[i].min(f32::from(last[i]) * step + end);
            }
        }
        let mut mask = 0;
        for i in 0..WIDTH {
            let is_entered = near[i] <= far[i];
            mask |= u32::from(is_entered) << i;
            near[i] = if is_entered { near[i] } else { f32::INFINITY };
        }
        (mask, near)
    }

    #[inline(always)]
    fn leaves(node: &Node) -> u32 {
        (0..WIDTH).map(|i| u32::from(!node.children[i].is_node()) << i).sum()
    }

    #[inline(always)]
    fn gather(node: &Node, mask: u32, near: &[f32; WIDTH]) -> [Entry; WIDTH] {
        let mut entries = [0; WIDTH];
        let inside = (0..WIDTH).filter(|i| mask >> i & 1 == 1);
        entries.iter_mut().zip(inside).for_each(|(place, i)| *place = entry(near[i], node.children[i]));
        entries
    }

    #[inline(always)]
    fn nearest(near: &[f32; WIDTH]) -> usize {
        (0..WIDTH).min_by_key(|i| near[*i].to_bits()).unwrap_or_default()
    }

    #[inline(always)]
    fn pick(node: &Node, mask: u32) -> [Child; WIDTH] {
        let mut children = [Child::NOTHING; WIDTH];
        let inside = (0..WIDTH).filter(|i| mask >> i & 1 == 1);
        children.iter_mut().zip(inside).for_each(|(place, i)| *place = node.children[i]);
        children
    }

    #[inline(always)]
    fn meet(ray: &WatertightRay, block: &TriangleBlock, t_max: f32) -> Option<Crossings> {
        let mut crossings = Crossings::NONE;
        for i in 0..LANES {
            if let Some((t, u, v)) = ray.intersect(&block.triangle(i), t_max) {
                crossings.mask |= 1 << i;
                crossings.t[i] = t;
                crossings.weights[0][i] = u;
                crossings.weights[1][i] = v;
            }
        }
        (crossings.mask != 0).then_some(crossings)
    }

    #[inline(never)]
    fn answer<Q: Query>(query: Q) -> Q::Answer {
        query.answer::<Self>()
    }

    #[inline(always)]
    fn prefetch(_: &[Word], _: Child) {}
}
