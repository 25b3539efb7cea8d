//! The judge on any two texts: no panic, levels in range, symmetric, and identical texts are identical.
#![no_main]

use libfuzzer_sys::fuzz_target;
use revisit::semantics::{Text, addresses_a_model, clean, conflict, information, merge, similarity, similarity_level};

fuzz_target!(|texts: (&str, &str)| {
    let (a, b) = (Text::parse(texts.0), Text::parse(texts.1));
    let (there, back) = (similarity(&a, &b), similarity(&b, &a));
    assert_eq!(there, back);
    assert!((1..=5).contains(&there.level));
    assert_eq!(similarity_level(&a, &b).0, there.level);
    assert_eq!(conflict(&a, &b).is_some(), conflict(&b, &a).is_some());
    for text in [&a, &b] {
        assert!((1..=5).contains(&information(text).0));
    }
    let once = clean(texts.0);
    assert_eq!(clean(&once), once);
    let _ = (merge(texts.0, texts.1), addresses_a_model(texts.0));
});
