//! Picture: an image decoded within limits and re-encoded, so that nothing but its pixels is sent.

use thiserror::Error;

/// A decoded image.
#[derive(Clone, Default, PartialEq, Eq)]
pub struct Picture {
    /// As PNG.
    pub png: Vec<u8>,
    /// SHA-256 of its size and pixels, so that the same image in another file has the same hash.
    pub hash: [u8; 32],
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
}

/// The reason why a file cannot be sent as an image.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("the crop cannot be decoded")]
pub struct NoPicture;

impl std::fmt::Debug for Picture {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Picture({} x {})", self.width, self.height)
    }
}
