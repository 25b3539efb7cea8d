//! Packed lists in rows, and base64 in bodies.
#![no_main]

use libfuzzer_sys::fuzz_target;
use revisit::store::unpacks;
use revisit::api::decoding::base64;

fuzz_target!(|bytes: &[u8]| {
    unpacks(bytes);
    if let Ok(text) = str::from_utf8(bytes) {
        let _ = base64::decode(text);
    }
    assert_eq!(base64::decode(&base64::encode(bytes)).as_deref(), Ok(bytes));
});
