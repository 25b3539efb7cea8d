//! The paper over HTTP: for each section one scenario that shows that its result reaches the answers, and what is HTTP's own.
//!
//! The claims themselves, against numbers computed by hand, are asked of the core: `crates/core/tests/paper/`, by the same names
//! of files; its `main.rs` has the table of sections. `repeat.rs` (M52: the same question, the same bytes) is here only,
//! and `letter.rs` (M51) there only.
//!
//! What the reader needs: keyframes have the word 1 unless they say otherwise, so that they are candidates of each other;
//! they stand at the origin and look along z unless they say otherwise, so that a position is what the camera sees.

mod candidates;
mod closing;
mod code_classes;
mod construction;
mod contradiction;
mod correction;
mod distinctive;
mod equation;
mod evidence;
mod inline;
mod kinds;
mod levels;
mod local_map;
mod matching;
mod numbering;
mod overview;
mod passage;
mod repeat;
mod scene;
mod sessions;
mod strictness;
mod tracking;
mod verdicts;
mod votes;
