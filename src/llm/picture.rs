//! An image as it is sent: decoded within limits and written anew, so that nothing but its pixels travels on.

use thiserror::Error;

/// An image that was decoded.
#[derive(Clone, PartialEq, Eq)]
pub struct Picture {
    /// As PNG.
    pub png: Vec<u8>,
    /// SHA-256 of its size and pixels: the same image in another file is the same image.
    pub hash: [u8; 32],
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
}

/// Why a file is no image to be sent.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("the crop cannot be decoded")]
pub struct NoPicture;

impl std::fmt::Debug for Picture {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Picture({} x {})", self.width, self.height)
    }
}
