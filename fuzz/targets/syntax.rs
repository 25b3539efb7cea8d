//! Any bytes are a JSON value or a place where they stop being one; what we take, serde_json takes too.
#![no_main]

use libfuzzer_sys::fuzz_target;
use revisit::api::decoding::document::Document;
use revisit::api::decoding::{digest, syntax};

fuzz_target!(|bytes: &[u8]| {
    if let Ok(document) = syntax::parse(bytes) {
        let value: serde_json::Value = serde_json::from_slice(bytes).expect("what we take is JSON");
        let digest = |document: &Document<'_>| digest::of(document.root(), None);
        assert_eq!(digest(&document), digest(&Document::from(&value)));
        let again = serde_json::to_vec(&value).expect("a value is written");
        assert_eq!(digest(&document), digest(&syntax::parse(&again).expect("JSON of ours")));
    }
});
