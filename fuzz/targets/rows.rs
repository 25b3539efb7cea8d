//! Packed lists in rows, and base64 in bodies.
#![no_main]

use libfuzzer_sys::fuzz_target;
use revisit::store::unpacks;
use revisit::api::decoding::document::Document;
use revisit::api::decoding::{base64, read};

fuzz_target!(|bytes: &[u8]| {
    unpacks(bytes);
    if let Ok(text) = str::from_utf8(bytes) {
        let _ = read::decode_with(Document::from(&text.into()).root(), base64::decode);
    }
    let decoded = read::decode_with(Document::from(&base64::encode(bytes).into()).root(), base64::decode);
    assert_eq!(decoded.as_deref(), Ok(bytes));
});
