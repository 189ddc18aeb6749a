//! The tests by AVX2.
//!
//! What is unsafe here is calling functions that are compiled for AVX2 from such that are not: [`Avx2`] is used only where
//! [`is_available`] found that the processor has it.
#![allow(unsafe_code)]

use std::arch::x86_64::*;

use bytemuck::{must_cast, must_cast_ref};
use glam::Vec3A;

use super::kernel::{Crossings, Entry, Kernel, Portable, Query};
use super::node::{Child, LANES, Node, TriangleBlock, WIDTH, Word};
use super::prepared::NodeRay;
use crate::raycast::watertight::WatertightRay;

/// By AVX2.
pub struct Avx2;

/// A [`NodeRay`], each of its numbers eight times.
pub struct Boxes {
    inverse: [__m256; 3],
    offsets: [[__m256; 3]; 2],
}

/// True if the processor has what it takes.
pub fn is_available() -> bool {
    is_x86_feature_detected!("avx2")
        && is_x86_feature_detected!("fma")
        && is_x86_feature_detected!("bmi1")
        && is_x86_feature_detected!("popcnt")
}

impl Kernel for Avx2 {
    type Boxes = Boxes;

    #[inline(always)]
    fn prepare(ray: &NodeRay) -> Boxes {
        // SAFETY: see the module.
        unsafe { prepare(ray) }
    }

    #[inline(always)]
    fn enter(ray: &Boxes, first: &[usize; 3], node: &Node, t_max: f32) -> (u32, [f32; WIDTH]) {
        // SAFETY: see the module.
        unsafe { enter(ray, first, node, t_max) }
    }

    #[inline(always)]
    fn leaves(node: &Node) -> u32 {
        // SAFETY: see the module.
        unsafe { leaves(node) }
    }

    #[inline(always)]
    fn gather(node: &Node, mask: u32, near: &[f32; WIDTH]) -> [Entry; WIDTH] {
        // SAFETY: see the module.
        unsafe { gather(node, mask, near) }
    }

    #[inline(always)]
    fn nearest(near: &[f32; WIDTH]) -> usize {
        // SAFETY: see the module.
        unsafe { nearest(near) }
    }

    #[inline(always)]
    fn pick(node: &Node, mask: u32) -> [Child; WIDTH] {
        // SAFETY: see the module.
        unsafe { pick(node, mask) }
    }

    #[inline(always)]
    fn meet(ray: &WatertightRay, block: &TriangleBlock, t_max: f32) -> Option<Crossings> {
        meet(ray, block, t_max)
    }

    fn answer<Q: Query>(query: Q) -> Q::Answer {
        #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
        fn answer<Q: Query>(query: Q) -> Q::Answer {
            query.answer::<Avx2>()
        }
        // SAFETY: see the module.
        unsafe { answer(query) }
    }

    #[inline(always)]
    fn prefetch(words: &[Word], child: Child) {
        let start = words.as_ptr().wrapping_add(child.0 as usize).cast::<i8>();
        for line in 0..3 {
            // SAFETY: reads nothing, and nothing happens where there is no memory.
            unsafe { _mm_prefetch::<_MM_HINT_T0>(start.wrapping_add(64 * line)) };
        }
    }
}

#[inline]
#[target_feature(enable = "avx2,fma,bmi1,popcnt")]
fn prepare(ray: &NodeRay) -> Boxes {
    let broadcast = |vector: Vec3A| vector.to_array().map(|x| _mm256_set1_ps(x));
    Boxes { inverse: broadcast(ray.inverse), offsets: ray.offsets.map(broadcast) }
}

#[inline]
#[target_feature(enable = "avx2,fma,bmi1,popcnt")]
fn enter(ray: &Boxes, first: &[usize; 3], node: &Node, t_max: f32) -> (u32, [f32; WIDTH]) {
    let slab = |axis: usize| {
        let inverse = ray.inverse[axis];
        let corner = _mm256_set1_ps(node.corner[axis]);
        let step = _mm256_mul_ps(_mm256_set1_ps(node.step), inverse);
        let at = |which: usize| {
            let walls = node.walls[axis][(first[axis] % 2) ^ which];
            let walls = _mm256_cvtepi32_ps(_mm256_cvtepu8_epi32(_mm_cvtsi64_si128(must_cast(walls))));
            let start = _mm256_fmadd_ps(corner, inverse, ray.offsets[which][axis]);
            _mm256_castps_si256(_mm256_fmadd_ps(walls, step, start))
        };
        [at(0), at(1)]
    };
    let [x, y, z] = [slab(0), slab(1), slab(2)];
    // Compared as integers, which takes a quarter of the time: numbers that are not negative have the same order, and others come before.
    let t_max = _mm256_castps_si256(_mm256_set1_ps(t_max));
    let near = _mm256_max_epi32(_mm256_max_epi32(x[0], y[0]), _mm256_max_epi32(z[0], _mm256_setzero_si256()));
    let far = _mm256_min_epi32(_mm256_min_epi32(x[1], y[1]), _mm256_min_epi32(z[1], t_max));
    let outside = _mm256_cmpgt_epi32(near, far);
    let mask = !_mm256_movemask_ps(_mm256_castsi256_ps(outside)) as u32 & 0xff;
    // Of the others, the largest integers.
    (mask, must_cast(_mm256_or_si256(near, _mm256_srli_epi32::<1>(outside))))
}

#[inline]
#[target_feature(enable = "avx2,fma,bmi1,popcnt")]
fn leaves(node: &Node) -> u32 {
    // Their lowest bits say so.
    let bits = _mm256_slli_epi32::<31>(must_cast(node.children));
    _mm256_movemask_ps(_mm256_castsi256_ps(bits)) as u32
}

/// By mask: which lanes are set in it, first.
static SET_LANES: [[u32; WIDTH]; 256] = set_lanes();

const fn set_lanes() -> [[u32; WIDTH]; 256] {
    let mut lanes = [[0; WIDTH]; 256];
    let mut mask = 0;
    while mask < 256 {
        let (mut lane, mut count) = (0, 0);
        while lane < WIDTH {
            if mask >> lane & 1 == 1 {
                lanes[mask][count] = lane as u32;
                count += 1;
            }
            lane += 1;
        }
        mask += 1;
    }
    lanes
}

#[inline]
#[target_feature(enable = "avx2,fma,bmi1,popcnt")]
fn gather(node: &Node, mask: u32, near: &[f32; WIDTH]) -> [Entry; WIDTH] {
    let lanes = must_cast(SET_LANES[mask as usize & 0xff]);
    let near = _mm256_permutevar8x32_epi32(must_cast(*near), lanes);
    let children = _mm256_permutevar8x32_epi32(must_cast(node.children), lanes);
    let (low, high) = (_mm256_unpacklo_epi32(children, near), _mm256_unpackhi_epi32(children, near));
    must_cast([_mm256_permute2x128_si256::<0x20>(low, high), _mm256_permute2x128_si256::<0x31>(low, high)])
}

#[inline]
#[target_feature(enable = "avx2,fma,bmi1,popcnt")]
fn pick(node: &Node, mask: u32) -> [Child; WIDTH] {
    let lanes = must_cast(SET_LANES[mask as usize & 0xff]);
    must_cast(_mm256_permutevar8x32_epi32(must_cast(node.children), lanes))
}

#[inline]
#[target_feature(enable = "avx2,fma,bmi1,popcnt")]
fn nearest(near: &[f32; WIDTH]) -> usize {
    let near: __m256i = must_cast(*near);
    let least = _mm256_min_epi32(near, _mm256_permute2x128_si256::<1>(near, near));
    let least = _mm256_min_epi32(least, _mm256_shuffle_epi32::<0b01_00_11_10>(least));
    let least = _mm256_min_epi32(least, _mm256_shuffle_epi32::<0b10_11_00_01>(least));
    let first = _mm256_movemask_ps(_mm256_castsi256_ps(_mm256_cmpeq_epi32(near, least)));
    first.trailing_zeros() as usize
}

/// The operations of [`WatertightRay::intersect`], in the same order. They are such as every processor has, so that this can be part of all
/// that call it: as a function of its own it would hand over its results by memory.
#[inline(always)]
fn meet(ray: &WatertightRay, block: &TriangleBlock, t_max: f32) -> Option<Crossings> {
    // With the indices as a tenth row, of which no axis leads out.
    let rows: &[[f32; LANES]; 10] = must_cast_ref(block);
    // SAFETY: SSE belongs to x86-64.
    unsafe {
        let [ox, oy, oz] = ray.origin.to_array().map(|origin| _mm_set1_ps(origin));
        let [shear_x, shear_y, shear_z] = ray.shear.to_array().map(|shear| _mm_set1_ps(shear));
        let sheared = |corner: usize| {
            let [x, y, z]: [__m128; 3] = ray.axes.map(|axis| must_cast(rows[3 * corner + axis % 4]));
            let (x, y, z) = (_mm_sub_ps(x, ox), _mm_sub_ps(y, oy), _mm_sub_ps(z, oz));
            (_mm_sub_ps(x, _mm_mul_ps(shear_x, z)), _mm_sub_ps(y, _mm_mul_ps(shear_y, z)), z)
        };
        let [a, b, c] = [sheared(0), sheared(1), sheared(2)];
        // Not fused: seen from its two triangles, an edge must give exactly opposite numbers.
        let side = |p: (__m128, __m128, __m128), q: (__m128, __m128, __m128)| {
            _mm_sub_ps(_mm_mul_ps(p.0, q.1), _mm_mul_ps(p.1, q.0))
        };
        let [u, v, w] = [side(c, b), side(a, c), side(b, a)];
        let zero = _mm_setzero_ps();
        // False for NaN, which empty places lead to.
        let right = _mm_cmpge_ps(_mm_min_ps(_mm_min_ps(u, v), w), zero);
        let left = _mm_cmple_ps(_mm_max_ps(_mm_max_ps(u, v), w), zero);
        let inside = _mm_or_ps(right, left);
        if _mm_movemask_ps(inside) == 0 {
            return None;
        }
        let on_edge =
            _mm_or_ps(_mm_or_ps(_mm_cmpeq_ps(u, zero), _mm_cmpeq_ps(v, zero)), _mm_cmpeq_ps(w, zero));
        if _mm_movemask_ps(_mm_and_ps(on_edge, inside)) != 0 {
            return meet_edge(ray, block, t_max);
        }
        let determinant = _mm_add_ps(_mm_add_ps(u, v), w);
        let depth = _mm_add_ps(_mm_add_ps(_mm_mul_ps(u, a.2), _mm_mul_ps(v, b.2)), _mm_mul_ps(w, c.2));
        let t = _mm_div_ps(_mm_mul_ps(shear_z, depth), determinant);
        // Without an edge, the determinant is none of zero.
        let within = _mm_and_ps(_mm_cmpgt_ps(t, zero), _mm_cmple_ps(t, _mm_set1_ps(t_max)));
        let mask = _mm_movemask_ps(_mm_and_ps(within, inside)) as u32;
        (mask != 0).then_some(Crossings {
            mask,
            t: must_cast(t),
            weights: [must_cast(v), must_cast(w)],
            determinant: must_cast(determinant),
        })
    }
}

/// For a ray through an edge or, in single precision, nearly so.
#[cold]
#[inline(never)]
fn meet_edge(ray: &WatertightRay, block: &TriangleBlock, t_max: f32) -> Option<Crossings> {
    Portable::meet(ray, block, t_max)
}
