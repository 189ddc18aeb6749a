//! The tests by AVX-512: of a node, lower and upper walls are computed together.
//!
//! What is unsafe here is calling functions that are compiled for AVX-512 from such that are not: [`Avx512`] is used only where
//! [`is_available`] found that the processor has it.
#![allow(unsafe_code)]

use std::arch::x86_64::*;

use bytemuck::must_cast;

use super::avx2;
use super::kernel::{Crossings, Entry, Kernel, Query};
use super::node::{Child, Node, TriangleBlock, WIDTH, Word};
use super::prepared::NodeRay;
use crate::raycast::watertight::WatertightRay;

/// By AVX-512.
pub struct Avx512;

/// True if the processor has what it takes.
pub fn is_available() -> bool {
    avx2::is_available()
        && is_x86_feature_detected!("avx512f")
        && is_x86_feature_detected!("avx512vl")
        && is_x86_feature_detected!("avx512bw")
        && is_x86_feature_detected!("avx512dq")
}

/// A [`NodeRay`] by axis: in the lower halves for the walls that are met first, in the upper ones for those that are met last.
pub struct Boxes {
    inverse: [__m512; 3],
    offset: [__m512; 3],
    /// Brings the walls of a node into that order.
    order: [__m128i; 3],
}

impl Kernel for Avx512 {
    type Boxes = Boxes;

    #[inline(always)]
    fn prepare(ray: &NodeRay) -> Boxes {
        // SAFETY: see the module.
        unsafe { prepare(ray) }
    }

    #[inline(always)]
    fn enter(ray: &Boxes, node: &Node, t_max: f32) -> (u32, [f32; WIDTH]) {
        // SAFETY: see the module.
        unsafe { enter(ray, node, t_max) }
    }

    #[inline(always)]
    fn gather(node: &Node, mask: u32, near: &[f32; WIDTH]) -> [Entry; WIDTH] {
        // SAFETY: see the module.
        unsafe { gather(node, mask, near) }
    }

    #[inline(always)]
    fn meet(ray: &WatertightRay, block: &TriangleBlock, t_max: f32) -> Crossings {
        avx2::meet(ray, block, t_max)
    }

    fn answer<Q: Query>(query: Q) -> Q::Answer {
        #[target_feature(enable = "avx2,fma,bmi1,popcnt,avx512f,avx512vl,avx512bw,avx512dq")]
        fn answer<Q: Query>(query: Q) -> Q::Answer {
            query.answer::<Avx512>()
        }
        // SAFETY: see the module.
        unsafe { answer(query) }
    }

    #[inline(always)]
    fn prefetch(words: &[Word], child: Child) {
        avx2::Avx2::prefetch(words, child);
    }
}

#[inline]
#[target_feature(enable = "avx2,fma,bmi1,popcnt,avx512f,avx512vl,avx512bw,avx512dq")]
fn prepare(ray: &NodeRay) -> Boxes {
    let inverse = [0, 1, 2].map(|axis| _mm512_set1_ps(ray.inverse[axis]));
    let offset = [0, 1, 2].map(|axis| {
        let [first, last] = ray.offsets.map(|offset| _mm512_set1_ps(offset[axis]));
        _mm512_mask_blend_ps(0xff00, first, last)
    });
    let straight = _mm_setr_epi8(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
    let order = [0, 1, 2].map(|axis| _mm_xor_si128(straight, _mm_set1_epi8(8 * ray.first(axis) as i8)));
    Boxes { inverse, offset, order }
}

#[inline]
#[target_feature(enable = "avx2,fma,bmi1,popcnt,avx512f,avx512vl,avx512bw,avx512dq")]
fn enter(ray: &Boxes, node: &Node, t_max: f32) -> (u32, [f32; WIDTH]) {
    let slab = |axis: usize| {
        let inverse = ray.inverse[axis];
        let start = _mm512_fmadd_ps(_mm512_set1_ps(node.corner[axis]), inverse, ray.offset[axis]);
        let walls = _mm_shuffle_epi8(must_cast(node.walls[axis]), ray.order[axis]);
        let walls = _mm512_cvtepi32_ps(_mm512_cvtepu8_epi32(walls));
        _mm512_fmadd_ps(walls, _mm512_mul_ps(_mm512_set1_ps(node.step), inverse), start)
    };
    let [x, y, z] = [0, 1, 2].map(|axis| _mm512_castps_si512(slab(axis)));
    // As integers: see AVX2.
    let near = _mm512_castsi512_si256(_mm512_max_epi32(_mm512_max_epi32(x, y), z));
    let far = _mm512_extracti64x4_epi64::<1>(_mm512_min_epi32(_mm512_min_epi32(x, y), z));
    let near = _mm256_max_epi32(near, _mm256_setzero_si256());
    let far = _mm256_min_epi32(far, _mm256_castps_si256(_mm256_set1_ps(t_max)));
    (u32::from(_mm256_cmple_epi32_mask(near, far)), must_cast(near))
}

#[inline]
#[target_feature(enable = "avx2,fma,bmi1,popcnt,avx512f,avx512vl,avx512bw,avx512dq")]
fn gather(node: &Node, mask: u32, near: &[f32; WIDTH]) -> [Entry; WIDTH] {
    let children = _mm512_castsi256_si512(must_cast(node.children));
    let near = _mm512_castsi256_si512(must_cast(*near));
    let pairs = _mm512_setr_epi32(0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23);
    let entries = _mm512_permutex2var_epi32(children, pairs, near);
    let entries = _mm512_maskz_compress_epi64(mask as u8, entries);
    must_cast([_mm512_castsi512_si256(entries), _mm512_extracti64x4_epi64::<1>(entries)])
}
