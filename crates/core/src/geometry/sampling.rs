//! Seeded random samples: the same seed gives the same samples, on any machine.

/// SplitMix64 (G. L. Steele, D. Lea, C. H. Flood, OOPSLA 2014): a 64-bit counter with a mixing function. Small, fast,
/// passes `BigCrush`, and every seed is a good one.
#[derive(Clone, Debug)]
pub struct SplitMix64 {
    state: u64,
}

impl SplitMix64 {
    /// Returns the generator of a seed.
    pub fn new(seed: u64) -> Self {
        Self { state: seed }
    }

    /// Returns the next 64 random bits.
    pub fn next_u64(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.state ^ (self.state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Returns a number below `bound`, which must not be 0. The high half of a product (Lemire 2019, without
    /// rejection): the bias is below `bound / 2^64`.
    pub fn below(&mut self, bound: usize) -> usize {
        ((u128::from(self.next_u64()) * bound as u128) >> 64) as usize
    }

    /// Three different numbers below `bound`, which must be 3 or more.
    pub fn three_below(&mut self, bound: usize) -> [usize; 3] {
        let first = self.below(bound);
        let mut second = self.below(bound - 1);
        second += usize::from(second >= first);
        let mut third = self.below(bound - 2);
        third += usize::from(third >= first.min(second));
        third += usize::from(third >= first.max(second));
        [first, second, third]
    }
}

/// Returns the chance that `samples` samples of three all held an outlier, when this share of the pairs are inliers.
pub fn chance_of_only_bad_samples(inlier_share: f64, samples: u32) -> f64 {
    (1.0 - inlier_share.powi(3)).powi(samples as i32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_generator_is_splitmix64() {
        // The first outputs of the published algorithm for seed 0.
        let mut random = SplitMix64::new(0);
        assert_eq!(random.next_u64(), 0xe220_a839_7b1d_cdaf);
        assert_eq!(random.next_u64(), 0x6e78_9e6a_a1b9_65f4);
        assert_eq!(random.next_u64(), 0x06c4_5d18_8009_454f);
    }

    #[test]
    fn every_ordered_triple_is_equally_likely() {
        let mut random = SplitMix64::new(7);
        let mut counts = std::collections::BTreeMap::new();
        for _ in 0..60_000 {
            let [a, b, c] = random.three_below(5);
            assert!(a != b && b != c && a != c && a.max(b).max(c) < 5);
            *counts.entry([a, b, c]).or_insert(0) += 1;
        }
        assert_eq!(counts.len(), 60);
        assert!(counts.values().all(|&count| (850..1150).contains(&count)));
    }

    #[test]
    fn the_chance_falls_with_the_samples() {
        assert_eq!(chance_of_only_bad_samples(0.0, 100), 1.0);
        assert_eq!(chance_of_only_bad_samples(1.0, 1), 0.0);
        assert!((chance_of_only_bad_samples(0.5, 35) - 0.009_34).abs() < 1e-5);
    }
}
