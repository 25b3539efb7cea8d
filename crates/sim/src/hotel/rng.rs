//! Random numbers: the only source of randomness in the hotel, by name and seed.
//!
//! Each part of a world draws from its own stream, named after its purpose. Moving a painting therefore does not
//! change the odometry, and all arms of an experiment see the same data.

use rand::{Rng, RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution as _, Normal};

/// A stream of random numbers.
#[derive(Clone, Debug)]
pub struct SeededRng(ChaCha8Rng);

impl SeededRng {
    /// Returns the stream of this name under this seed.
    pub fn new(seed: u64, name: &str) -> Self {
        // FNV-1a, which is stable across versions, unlike the standard library's hasher.
        let named = name.bytes().fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
        });
        let mut bytes = [0; 32];
        bytes[..8].copy_from_slice(&seed.to_le_bytes());
        bytes[8..16].copy_from_slice(&named.to_le_bytes());
        Self(ChaCha8Rng::from_seed(bytes))
    }

    /// Draws uniformly from `[low, high)`.
    pub fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.random::<f64>()
    }

    /// Draws uniformly below `bound`, which must not be 0.
    pub fn below(&mut self, bound: usize) -> usize {
        self.0.random_range(0..bound)
    }

    /// Returns true with this probability.
    pub fn happens(&mut self, probability: f64) -> bool {
        self.0.random::<f64>() < probability
    }

    /// Draws from a normal distribution around 0.
    pub fn normal(&mut self, sigma: f64) -> f64 {
        Normal::new(0.0, sigma).map_or(0.0, |normal| normal.sample(&mut self.0))
    }

    /// Draws 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.0.next_u64()
    }

    /// Draws one of several items.
    pub fn one_of<'a, T>(&mut self, items: &'a [T]) -> &'a T {
        &items[self.below(items.len())]
    }

    /// Shuffles a list.
    pub fn shuffle<T>(&mut self, items: &mut [T]) {
        for last in (1..items.len()).rev() {
            items.swap(last, self.below(last + 1));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stream_repeats_under_its_seed_and_name_and_no_other() {
        let first = |seed, name| SeededRng::new(seed, name).bits();
        assert_eq!(first(1, "walls"), first(1, "walls"));
        assert_ne!(first(1, "walls"), first(2, "walls"));
        assert_ne!(first(1, "walls"), first(1, "doors"));
    }

    #[test]
    fn shuffling_keeps_every_item() {
        let mut items: Vec<usize> = (0..50).collect();
        SeededRng::new(3, "test").shuffle(&mut items);
        assert_ne!(items, (0..50).collect::<Vec<_>>());
        items.sort_unstable();
        assert_eq!(items, (0..50).collect::<Vec<_>>());
    }
}
