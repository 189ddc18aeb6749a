//! The seeded low-discrepancy sample stream: one per (pixel, sample), dimensions assigned by place.
//!
//! A stream has no state. A number is asked for by *where* it is used ([`SampleStream::quad`] with a
//! set index), not by how many were drawn before, so switching an effect on or off moves no other
//! number, and a specialised kernel gives the bits of the generic one.

use sobol_burley::sample_4d;

/// Owen-scrambled Sobol numbers (Burley 2020, "Practical Hash-based Owen Scrambling") for one sample
/// of one pixel; beyond the sequence's 256 dimensions, hashed random numbers.
#[derive(Clone, Copy, Debug)]
pub struct SampleStream {
    /// Index within the block of 2¹⁶ samples that the sequence covers.
    index: u32,
    seed: u32,
    /// Identifies (seed, pixel, sample): seeds generators of numbers whose count is not known beforehand.
    key: u64,
}

const INDEX_BITS: u32 = 16;
const SOBOL_SETS: u32 = 64;

impl SampleStream {
    /// The stream of sample `sample` of pixel `pixel` (row-major index) under `seed`.
    pub fn new(seed: u64, pixel: u64, sample: u64) -> Self {
        let block = sample >> INDEX_BITS;
        let scramble = hash(hash(seed ^ hash(pixel)) ^ block);
        Self {
            index: (sample & ((1 << INDEX_BITS) - 1)) as u32,
            seed: scramble as u32,
            key: hash(scramble ^ hash(sample)),
        }
    }

    /// Four numbers in [0, 1) for the place `set`.
    pub fn quad(&self, set: u32) -> [f32; 4] {
        if set < SOBOL_SETS {
            return sample_4d(self.index, set, self.seed);
        }
        let a = hash(self.key ^ u64::from(set));
        let b = hash(a);
        [unit(a as u32), unit((a >> 32) as u32), unit(b as u32), unit((b >> 32) as u32)]
    }

    /// A generator for a place that needs an unknown count of numbers (retries).
    pub fn generator(&self, set: u32) -> HashGenerator {
        HashGenerator { state: hash(self.key ^ (u64::from(set) << 32) ^ 0x9e37_79b9_7f4a_7c15) }
    }
}

/// A small counter-based generator (SplitMix64, Steele et al. 2014).
#[derive(Clone, Copy, Debug)]
pub struct HashGenerator {
    state: u64,
}

impl HashGenerator {
    /// A generator from `seed`.
    pub fn new(seed: u64) -> Self {
        Self { state: hash(seed) }
    }

    /// The next number in [0, 1), on a grid of 2⁻²⁴.
    pub fn next_f32(&mut self) -> f32 {
        unit((self.next_u64() >> 32) as u32)
    }

    /// The next number from the exponential distribution of mean 1, positive, to 53 bits: its tail reaches
    /// beyond what single-precision uniform numbers can give.
    pub fn next_exponential(&mut self) -> f32 {
        let uniform = ((self.next_u64() >> 11) + 1) as f64 * (1.0 / (1_u64 << 53) as f64);
        -uniform.ln() as f32
    }

    fn next_u64(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        hash(self.state)
    }
}

/// Mixes 64 bits (Stafford 2011, variant 13, the finaliser of SplitMix64).
fn hash(mut x: u64) -> u64 {
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

fn unit(bits: u32) -> f32 {
    (bits >> 8) as f32 * (1.0 / 16_777_216.0)
}
