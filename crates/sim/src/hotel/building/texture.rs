//! Texture: the appearance of a point, as a 256-bit descriptor similar to ORB.
//!
//! Corners in the world are variations of a few thousand patterns, such as a door frame's corner or the leg of a
//! chair. This is why a vocabulary trained on one building works in another. A descriptor therefore has layers, each
//! of which flips a share of the bits: the pattern, the model, the copy, the viewing side, and the noise of one image.
//! A model is this corner of this make of chair; a copy is this very chair, with a scratch. The shares add up to
//! measurements of ORB: two views of one point differ in 20 to 45 of 256 bits, different points in about 128 (E.
//! Rublee et al., ICCV 2011).

use crate::hotel::rng::SeededRng;
use crate::vocabulary::Vocabulary;
use crate::vocabulary::train::{TrainError, TrainSettings, TrainingSet, train};

/// A descriptor of 256 bits.
pub type Descriptor = [u64; 4];

/// Bits of a descriptor.
pub const DESCRIPTOR_BITS: usize = 256;
/// Number of patterns in the world.
pub const PATTERNS: usize = 1_500;
/// Bits in which a model's corner differs from its pattern.
const MODEL_BITS: f64 = 22.0;
/// Bits in which a copy differs from its model.
const COPY_BITS: f64 = 17.0;
/// Bits in which a side view differs from the front.
const SIDE_BITS: f64 = 9.0;
/// Bits of noise of one image.
const IMAGE_BITS: f64 = 8.0;
/// Number of images for training the vocabulary, drawn independently of every world.
const TRAINING_IMAGES: usize = 150;
/// Number of corners in each of them.
const TRAINING_CORNERS: usize = 80;
/// Seed of the patterns, which are the same for all worlds, as corners are in all buildings.
const PATTERN_SEED: u64 = 0x4f52_4220_7061_7474;

/// The patterns of the world.
#[derive(Clone, Debug)]
pub struct Patterns(Vec<Descriptor>);

impl Patterns {
    /// Returns the patterns, always the same.
    pub fn new() -> Self {
        let mut rng = SeededRng::new(PATTERN_SEED, "patterns");
        Self((0..PATTERNS).map(|_| std::array::from_fn(|_| rng.bits())).collect())
    }

    /// Returns a new model's corner: a variation of a random pattern.
    pub fn model(&self, rng: &mut SeededRng) -> Descriptor {
        varied(*rng.one_of(&self.0), MODEL_BITS, rng)
    }

    /// Trains a vocabulary on images that belong to no world.
    pub fn vocabulary(&self) -> Result<Vocabulary, TrainError> {
        let mut rng = SeededRng::new(PATTERN_SEED, "vocabulary");
        let mut set = TrainingSet::default();
        for _ in 0..TRAINING_IMAGES {
            let corners = (0..TRAINING_CORNERS).map(|_| copy(self.model(&mut rng), &mut rng));
            let image: Vec<u8> = corners.collect::<Vec<_>>().iter().flat_map(bytes).collect();
            set.add_image(DESCRIPTOR_BITS / 8, &image)?;
        }
        // Five levels, so that the nodes that guide matching are one level below the root.
        train(&set, TrainSettings { branching: 10, levels: 5, ..TrainSettings::default() }, |_| {})
    }
}

impl Default for Patterns {
    fn default() -> Self {
        Self::new()
    }
}

/// Returns a copy of a model's corner.
pub fn copy(model: Descriptor, rng: &mut SeededRng) -> Descriptor {
    varied(model, COPY_BITS, rng)
}

/// Returns the point as seen from a side; the same side always flips the same bits.
pub fn from_side(point: Descriptor, side: i32) -> Descriptor {
    let seed = point[0] ^ (side as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    varied(point, SIDE_BITS, &mut SeededRng::new(seed, "side"))
}

/// Returns the point in one image, with noise.
pub fn in_image(side: Descriptor, rng: &mut SeededRng) -> Descriptor {
    varied(side, IMAGE_BITS, rng)
}

/// Returns a descriptor's bytes, as they are sent.
pub fn bytes(descriptor: &Descriptor) -> impl Iterator<Item = u8> + use<> {
    descriptor.map(u64::to_le_bytes).into_iter().flatten()
}

/// Flips a random number of bits, on average `mean_bits`, within a third of it.
fn varied(mut descriptor: Descriptor, mean_bits: f64, rng: &mut SeededRng) -> Descriptor {
    let count = rng.within(mean_bits * 0.67, mean_bits * 1.33).round() as usize;
    for _ in 0..count {
        let bit = rng.below(DESCRIPTOR_BITS);
        descriptor[bit / 64] ^= 1 << (bit % 64);
    }
    descriptor
}

#[cfg(test)]
mod tests {
    use super::*;

    fn distance(a: &Descriptor, b: &Descriptor) -> u32 {
        a.iter().zip(b).map(|(a, b)| (a ^ b).count_ones()).sum()
    }

    #[test]
    fn layers_add_up_to_what_is_measured_of_orb() {
        let (patterns, mut rng) = (Patterns::new(), SeededRng::new(5, "test"));
        let mut mean = |a: &dyn Fn(&mut SeededRng) -> (Descriptor, Descriptor)| -> f64 {
            let sum: u32 = (0..300)
                .map(|_| {
                    let (a, b) = a(&mut rng);
                    distance(&a, &b)
                })
                .sum();
            f64::from(sum) / 300.0
        };
        let one_side = mean(&|rng| {
            let point = patterns.model(rng);
            (in_image(from_side(point, 0), rng), in_image(from_side(point, 0), rng))
        });
        let two_sides = mean(&|rng| {
            let point = patterns.model(rng);
            (in_image(from_side(point, 0), rng), in_image(from_side(point, 2), rng))
        });
        let twins = mean(&|rng| {
            let model = patterns.model(rng);
            let (a, b) = (copy(model, rng), copy(model, rng));
            (in_image(from_side(a, 0), rng), in_image(from_side(b, 0), rng))
        });
        let strangers = mean(&|rng| (patterns.model(rng), patterns.model(rng)));
        assert!((12.0..20.0).contains(&one_side), "one side: {one_side}");
        assert!((25.0..40.0).contains(&two_sides), "two sides: {two_sides}");
        assert!((40.0..60.0).contains(&twins), "twins: {twins}");
        assert!((120.0..135.0).contains(&strangers), "strangers: {strangers}");
    }
}
