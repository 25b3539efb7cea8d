//! Crops: any file is a picture of bounded size, which is the same picture when it is read again, or none.
#![no_main]

use libfuzzer_sys::fuzz_target;
use revisit::llm::picture::Picture;

fuzz_target!(|bytes: &[u8]| {
    let Ok(picture) = Picture::decode(bytes) else { return };
    assert!(picture.width.max(picture.height) <= 1024, "{picture:?}");
    let again = Picture::decode(&picture.png).expect("a file of ours");
    assert_eq!(again.hash, picture.hash);
});
