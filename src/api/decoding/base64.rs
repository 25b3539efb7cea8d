//! Base64 as members of a body carry it: the standard alphabet, with or without padding.

use base64::Engine as _;
use base64::engine::DecodePaddingMode;
use base64::engine::general_purpose::{GeneralPurpose, GeneralPurposeConfig};

const ENGINE: GeneralPurpose = GeneralPurpose::new(
    &base64::alphabet::STANDARD,
    GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent),
);

/// Returns the bytes of a string of base64, or why it is none.
pub fn decode(text: &str) -> Result<Vec<u8>, String> {
    ENGINE.decode(text).map_err(|error| error.to_string())
}

/// Bytes as a string of base64, padded.
pub fn encode(bytes: &[u8]) -> String {
    ENGINE.encode(bytes)
}
