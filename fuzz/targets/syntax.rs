//! Any bytes are a JSON value or a place where they stop being one; what we take, serde_json takes too.
#![no_main]

use libfuzzer_sys::fuzz_target;
use revisit::api::decoding::document::{Json, Kind};
use revisit::api::decoding::syntax;
use serde_json::Value;

fn value(json: Json<'_>) -> Value {
    match json.kind() {
        Kind::Null => Value::Null,
        Kind::Bool => json.as_bool().into(),
        Kind::Number => json.as_number().into(),
        Kind::Text => json.as_str().into(),
        Kind::List => json.items().map(value).collect(),
        Kind::Object => json.members().map(|(name, member)| (name.to_owned(), value(member))).collect(),
    }
}

fuzz_target!(|bytes: &[u8]| {
    if let Ok(document) = syntax::parse(bytes) {
        let expected: Value = serde_json::from_slice(bytes).expect("what we take is JSON");
        assert_eq!(value(document.root()), expected);
        let again = serde_json::to_vec(&expected).expect("a value is written");
        assert_eq!(value(syntax::parse(&again).expect("JSON of ours").root()), expected);
    }
});
