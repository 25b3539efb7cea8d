//! Base64 as members of a body carry it: the standard alphabet, with or without padding.

use base64::Engine as _;
use base64::engine::DecodePaddingMode;
use base64::engine::general_purpose::{GeneralPurpose, GeneralPurposeConfig};

use super::read::Node;

const ENGINE: GeneralPurpose = GeneralPurpose::new(
    &base64::alphabet::STANDARD,
    GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent),
);

/// Reads a string of base64.
pub fn decode(node: &Node<'_>) -> Option<Vec<u8>> {
    match ENGINE.decode(node.string()?) {
        Ok(bytes) => Some(bytes),
        Err(error) => node.refuse(format!("not base64: {error}"), "A-Z a-z 0-9 + / and padding with ="),
    }
}

/// Bytes as a string of base64, padded.
pub fn encode(bytes: &[u8]) -> String {
    ENGINE.encode(bytes)
}
