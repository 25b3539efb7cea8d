//! A training set: the descriptors of images, packed.

use super::error::TrainError;
use crate::vocabulary::transform::pack;

/// Descriptors of one length, image by image.
#[derive(Clone, Debug, Default)]
pub struct TrainingSet {
    /// 64-bit words of a descriptor; 0 until there is one.
    each: usize,
    descriptors: Vec<u64>,
    /// Where the descriptors of each image end, in 64-bit words.
    image_ends: Vec<usize>,
}

impl TrainingSet {
    /// Adds the descriptors of an image, of `descriptor_bytes` bytes each. An image without any counts for nothing.
    pub fn add_image(&mut self, descriptor_bytes: usize, descriptors: &[u8]) -> Result<(), TrainError> {
        if descriptors.is_empty() {
            return Ok(());
        }
        let fits = descriptor_bytes.is_multiple_of(8) && (8..=512).contains(&descriptor_bytes);
        if !fits || !descriptors.len().is_multiple_of(descriptor_bytes) {
            return Err(TrainError::Length { bytes: descriptors.len(), each: descriptor_bytes });
        }
        if self.each != 0 && self.each * 8 != descriptor_bytes {
            return Err(TrainError::MixedDescriptors { got: descriptor_bytes, expected: self.each * 8 });
        }
        let added = descriptors.len() / descriptor_bytes;
        if self.descriptor_count() + added > u32::MAX as usize {
            return Err(TrainError::TooMany);
        }
        self.each = descriptor_bytes / 8;
        self.descriptors.extend(pack(descriptors));
        self.image_ends.push(self.descriptors.len());
        Ok(())
    }

    /// Returns how many images have descriptors.
    pub fn image_count(&self) -> usize {
        self.image_ends.len()
    }

    /// Returns the number of descriptors.
    pub fn descriptor_count(&self) -> usize {
        self.descriptors.len().checked_div(self.each).unwrap_or(0)
    }

    /// Bytes of one descriptor, if there is one.
    pub fn descriptor_bytes(&self) -> Option<usize> {
        (self.each > 0).then_some(self.each * 8)
    }

    /// Returns the descriptors of each image.
    pub(super) fn images(&self) -> impl Iterator<Item = &[u64]> {
        let mut start = 0;
        self.image_ends.iter().map(move |&end| {
            let image = &self.descriptors[start..end];
            start = end;
            image
        })
    }

    /// One descriptor.
    pub(super) fn descriptor(&self, number: u32) -> &[u64] {
        &self.descriptors[number as usize * self.each..][..self.each]
    }

    /// Whether these descriptors are all the same.
    pub(super) fn all_equal(&self, numbers: &[u32]) -> bool {
        numbers.windows(2).all(|pair| self.descriptor(pair[0]) == self.descriptor(pair[1]))
    }
}
