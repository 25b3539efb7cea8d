//! Decoding: from the bytes of a body to a checked value, with every fault and its place.

pub mod base64;
pub mod digest;
pub(super) mod faults;
pub mod json_footprint;
pub mod read;
pub mod syntax;
