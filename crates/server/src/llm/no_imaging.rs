//! Imaging without the feature `llm`: crops are neither decoded nor described.

use super::picture::{NoPicture, Picture};

impl Picture {
    /// Decodes nothing.
    pub fn decode(_: &[u8]) -> Result<Self, NoPicture> {
        Err(NoPicture)
    }
}

pub(super) fn page(_: &Picture) -> Option<Vec<u8>> {
    None
}
