//! What a model answers: a level is from 1 to 5, a text is bounded and clean, and nothing else is taken.
#![no_main]

use libfuzzer_sys::fuzz_target;
use revisit::llm::parse;

fuzz_target!(|content: &str| {
    if let Ok((level, reason)) = parse::level(content) {
        assert!((1..=5).contains(&level));
        assert!(reason.is_none_or(|reason| reason.chars().count() <= 200));
    }
    for text in
        [parse::text(content), parse::look(content), parse::next_question(content)].into_iter().flatten()
    {
        assert!(text.chars().count() <= 2000);
        assert_eq!(revisit::semantics::clean(&text), text);
    }
});
