//! The transform: the descriptors of an image become its bag of words, and groups for matching.

use super::flat_tree::Vocabulary;
use super::groups::FeatureGroups;
use super::words::WordVector;
use crate::domain::keyframe::Features;

/// Levels above the words at which features are grouped for matching: ORB-SLAM's choice.
pub const LEVELS_UP: u32 = 4;

/// What the vocabulary makes of an image.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Transformed {
    /// TF-IDF, L1-normalised.
    pub words: WordVector,
    /// Features grouped by node. Those of words of weight 0 are in no group.
    pub groups: FeatureGroups,
}

/// Descriptors that are not the vocabulary's.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DescriptorMismatch {
    /// Descriptors of another length.
    #[error("the descriptors have {got} bytes each, the vocabulary's have {expected}")]
    Length {
        /// Bytes of a given one.
        got: usize,
        /// Bytes of the vocabulary's.
        expected: usize,
    },
    /// Bytes that are not whole descriptors.
    #[error("{bytes} bytes are not whole descriptors of {each} bytes")]
    Remainder {
        /// How many bytes were given.
        bytes: usize,
        /// Bytes of a descriptor.
        each: usize,
    },
}

impl Vocabulary {
    /// Returns the words of a keyframe's features, and their groups four levels above the words, as ORB-SLAM has them.
    pub fn transform_features(&self, features: &Features) -> Result<Transformed, DescriptorMismatch> {
        self.transform(features.descriptor_bytes, &features.descriptors, LEVELS_UP)
    }

    /// Returns the words of descriptors of `descriptor_bytes` bytes each, and their groups by the node at level `L -
    /// levels_up`.
    ///
    /// A group is named by the node's number in the vocabulary's file. A word above that level is a group by itself.
    pub fn transform(
        &self,
        descriptor_bytes: usize,
        descriptors: &[u8],
        levels_up: u32,
    ) -> Result<Transformed, DescriptorMismatch> {
        let packed = self.pack(descriptor_bytes, descriptors)?;
        let landings = self.descend(&packed, self.shape().levels.saturating_sub(levels_up));

        let parts = self.arrays.parts();
        let mut words = Vec::with_capacity(landings.len());
        let mut features = Vec::with_capacity(landings.len());
        for (feature, landing) in (0_u64..).zip(&landings) {
            if parts.weight(landing.word) > 0.0 {
                words.push(landing.word);
                features.push(u64::from(parts.node_id(landing.node)) << 32 | feature);
            }
        }
        words.sort_unstable();
        Ok(Transformed {
            words: WordVector::of_sorted(&words, |word| parts.weight(word)),
            groups: FeatureGroups::of(features),
        })
    }

    /// Returns the word of each descriptor, words of weight 0 included.
    pub fn words_of(
        &self,
        descriptor_bytes: usize,
        descriptors: &[u8],
    ) -> Result<Vec<u32>, DescriptorMismatch> {
        let packed = self.pack(descriptor_bytes, descriptors)?;
        Ok(self.descend(&packed, 0).iter().map(|landing| landing.word).collect())
    }

    fn pack(&self, descriptor_bytes: usize, descriptors: &[u8]) -> Result<Vec<u64>, DescriptorMismatch> {
        let expected = self.descriptor_bytes();
        if descriptor_bytes != expected {
            return Err(DescriptorMismatch::Length { got: descriptor_bytes, expected });
        }
        if !descriptors.len().is_multiple_of(expected) {
            return Err(DescriptorMismatch::Remainder { bytes: descriptors.len(), each: expected });
        }
        Ok(pack(descriptors))
    }
}

/// Bytes as 64-bit words, little endian; what is no whole word is left out.
pub(super) fn pack(bytes: &[u8]) -> Vec<u64> {
    bytes.as_chunks::<8>().0.iter().map(|word| u64::from_le_bytes(*word)).collect()
}
