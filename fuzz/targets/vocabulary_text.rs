//! DBoW2's text form: any bytes are a vocabulary, which reads back from what it writes, or a fault.
#![no_main]

use libfuzzer_sys::fuzz_target;
use revisit::vocabulary::Vocabulary;

fuzz_target!(|bytes: &[u8]| {
    let Ok(read) = Vocabulary::read_text(bytes) else { return };
    assert!(read.fingerprint_holds());
    let mut written = Vec::new();
    read.write_text(&mut written).expect("a vector takes all");
    let again = Vocabulary::read_text(&written[..]).expect("what we wrote");
    assert_eq!(again.fingerprint(), read.fingerprint());
});
