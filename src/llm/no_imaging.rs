//! Imaging in a program without the feature `llm`: nothing looks at crops, and none is decoded.

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
