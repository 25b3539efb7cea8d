//! The paper over HTTP: a test for each section and for each line of `contract.md` §8, against numbers computed by hand.
//!
//! | what | file |
//! |---|---|
//! | §III, an anchor seen before triggers; §8.10 | `overview.rs` |
//! | §IV-B, what an anchor is and when it is valid | `construction.rs` |
//! | §IV-C.1, object tracking; §8.2 (boxes), §8.3 | `tracking.rs` |
//! | §IV-C.2, anchor matching; §8.5 | `matching.rs` |
//! | §IV-C.2, several readings; §8.4 | `votes.rs` |
//! | §IV-C.2, a confirmed loop and its revocation; §8.12 | `closing.rs` |
//! | §V, checks 1 and 2; §8.9, §8.10 (places) | `candidates.rs` |
//! | §V-A, local anchor maps; §8.1, §8.2 | `local_map.rs` |
//! | §V-B, Eq. (1) and (2) | `equation.rs` |
//! | the gates of §V-B are strict | `strictness.rs` |
//! | §8.6 distinctive weights | `distinctive.rs` |
//! | §8.7 contradictions | `contradiction.rs` |
//! | §5 differing identifiers that are no contradictions | `differences.rs` |
//! | §5 verdicts: what is missing, and which checks run; §8.11 | `verdicts.rs` |
//! | §8.14 the built-in judge's levels | `levels.rs` |
//! | §8.14 texts that need a witness | `witness.rs` |
//! | §8.10 one passage, §8.14 unsure readings | `passage.rs` |
//! | sessions: two robots, or two days | `sessions.rs` |
//! | §6 poses, and culling | `correction.rs` |
//! | §5 an inline keyframe | `inline.rs` |
//! | §5 the same question, the same bytes | `repeat.rs` |
//!
//! What the reader needs: keyframes have the word 1 unless they say otherwise, so that they are candidates of each other;
//! they stand at the origin and look along z unless they say otherwise, so that a position is what the camera sees.

mod candidates;
mod closing;
mod construction;
mod contradiction;
mod correction;
mod differences;
mod distinctive;
mod equation;
mod inline;
mod letter;
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
mod witness;
