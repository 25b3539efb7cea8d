//! Ids, as they stand in paths and bodies: what is taken is short and plain, and reads back.
#![no_main]

use libfuzzer_sys::fuzz_target;
use revisit::domain::ids::{AnchorSeq, KeyframeId, MapId};

fuzz_target!(|text: &str| {
    if let Ok(id) = text.parse::<MapId>() {
        assert!(
            id.as_str() == text
                && text.len() <= 128
                && text.bytes().all(|b| b.is_ascii_graphic() && b != b'/')
        );
    }
    assert_eq!(text.parse::<KeyframeId>().is_ok(), text.parse::<MapId>().is_ok());
    if let Some(anchor) = AnchorSeq::from_public(text) {
        assert_eq!(anchor.public(), text);
    }
});
