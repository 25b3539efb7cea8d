//! Imaging in a program without the feature `llm`: nothing looks at crops, and none is decoded.

use super::picture::{NoPicture, Picture};

pub(super) fn decode(_: &[u8]) -> Result<Picture, NoPicture> {
    Err(NoPicture)
}

pub(super) fn page(_: &Picture) -> Option<Vec<u8>> {
    None
}
