//! Decoding: from the bytes of a body to a checked value, with every fault and its place.

pub mod base64;
pub mod column;
pub mod document;
pub(super) mod faults;
pub mod read;
mod scalars;
pub mod syntax;
