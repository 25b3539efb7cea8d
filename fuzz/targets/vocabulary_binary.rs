//! The binary form, plain or compressed: any bytes are a vocabulary, whose words can be weighed, or a fault.
#![no_main]

use std::io::Cursor;

use libfuzzer_sys::fuzz_target;
use revisit::vocabulary::Vocabulary;

fuzz_target!(|bytes: &[u8]| {
    let Ok(read) = Vocabulary::read(Cursor::new(bytes.to_vec())) else { return };
    for word in 0..read.word_count().min(100) {
        assert!(read.word_weight(word as u32).is_some_and(f64::is_finite));
    }
    let mut written = Vec::new();
    read.write_binary(&mut written).expect("a vector takes all");
    let again = Vocabulary::read_binary(&written[..]).expect("what we wrote");
    assert!(again == read);
});
