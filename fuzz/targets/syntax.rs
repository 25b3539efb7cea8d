//! Any bytes are a JSON value or a place where they stop being one; what we take, serde_json takes too.
#![no_main]

use libfuzzer_sys::fuzz_target;
use revisit::api::decoding::syntax;

fuzz_target!(|bytes: &[u8]| {
    if let Ok(value) = syntax::parse(bytes) {
        let again = serde_json::to_vec(&value).expect("a value is written");
        assert_eq!(syntax::parse(&again).as_ref(), Ok(&value));
        assert_eq!(serde_json::from_slice::<serde_json::Value>(bytes).ok(), Some(value));
    }
});
