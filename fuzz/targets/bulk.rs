//! Lines of a bulk request, as the body arrives cut in any pieces: each is a keyframe or a list of faults.
#![no_main]

use libfuzzer_sys::fuzz_target;
use revisit::api::bulk;
use revisit::api::decoding::syntax;

fuzz_target!(|bytes: &[u8]| {
    for line in bytes.split(|byte| *byte == b'\n') {
        let Ok(line) = syntax::parse(line) else { continue };
        let id = bulk::line_id(line.root());
        match bulk::decode(line.root()) {
            Ok(sent) => assert_eq!(id, Some(sent.keyframe.id.to_string())),
            Err(faulty) => assert!(!faulty.faults.is_empty()),
        }
    }
});
