//! Lines of a recording, plain or compressed.
#![no_main]

use std::io::Cursor;

use libfuzzer_sys::fuzz_target;
use revisit::cli::replay::count_operations;

fuzz_target!(|bytes: &[u8]| {
    let _ = count_operations(Cursor::new(bytes.to_vec()));
});
