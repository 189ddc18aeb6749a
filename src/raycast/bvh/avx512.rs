//! The tests by AVX-512: those by AVX2 with its masks, and with twice as many registers. Longer ones are slower here.
//!
//! What is unsafe here is calling functions that are compiled for AVX-512 from such that are not: [`Avx512`] is used only where
//! [`is_available`] found that the processor has it.
#![allow(unsafe_code)]

use std::arch::x86_64::*;

use bytemuck::must_cast;

use super::avx2::{self, Boxes};
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

impl Kernel for Avx512 {
    type Boxes = Boxes;

    #[inline(always)]
    fn prepare(ray: &NodeRay) -> Boxes {
        // SAFETY: see the module.
        unsafe { avx2::prepare(ray) }
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
    fn meet(ray: &WatertightRay, block: &TriangleBlock, t_max: f32) -> Option<Crossings> {
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
fn enter(ray: &Boxes, node: &Node, t_max: f32) -> (u32, [f32; WIDTH]) {
    let [near, far] = avx2::slabs(ray, node, t_max);
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
