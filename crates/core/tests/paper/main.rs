//! The paper, asked of the core: a test for each section and for the choices of `docs/method.md`, against numbers computed by hand.
//!
//! | what | file |
//! |---|---|
//! | §III, an anchor seen before triggers; M10 | `overview.rs` |
//! | §IV-B, what an anchor is and when it is valid | `construction.rs` |
//! | §IV-C.1, object tracking; M2 (boxes), M3 | `tracking.rs` |
//! | §IV-C.2, anchor matching; M5 | `matching.rs` |
//! | §IV-C.2, several readings; M4 | `votes.rs` |
//! | §IV-C.2, a confirmed loop and its revocation; M12 | `closing.rs` |
//! | §V, checks 1 and 2; M9, M34 | `candidates.rs` |
//! | §V-A, local anchor maps; M1, M2 | `local_map.rs` |
//! | §V-B, Eq. (1) and (2) | `equation.rs` |
//! | the gates of §V-B are strict | `strictness.rs` |
//! | M6, M27 distinctive weights | `distinctive.rs` |
//! | M7 contradictions, and what the sum makes of them | `contradiction.rs` |
//! | M10 one passage is no return, M21 unsure readings | `passage.rs` |
//! | M11, M28, M39 verdicts: what is missing, and which checks run | `verdicts.rs` |
//! | M14 names: wings, cut plates, notices | `names.rs` |
//! | M17 company, M20 numberings, M26 assumed distances | `numbering.rs` |
//! | M32 sessions: two robots, or two days | `sessions.rs` |
//! | M33 poses, and culling | `correction.rs` |
//! | M50 an inline keyframe | `inline.rs` |
//! | M55 prior anchors and plans | `plans.rs` |
//! | M51 the paper's method, written a second time | `letter.rs` |
//! | M62, M63 neighbours along the drive, returns that are closed once | `along_drive.rs` |
//! | M64 the sum of evidence, scene by scene | `sums.rs` |
//! | M64 the laws that no evidence breaks | `odds.rs` |
//!
//! What the reader needs: keyframes have the word 1 unless they say otherwise, so that they are candidates of each other;
//! they stand at the origin and look along z unless they say otherwise, so that a position is what the camera sees.
//! `tests/it/paper/` of the server shows, with one scenario a section, that the results reach its answers.

// Expected values may be computed with the platform's own sines.
#![allow(clippy::disallowed_methods)]

mod along_drive;
mod candidates;
mod closing;
mod construction;
mod contradiction;
mod correction;
mod distinctive;
mod equation;
mod inline;
mod letter;
mod local_map;
mod matching;
mod names;
mod numbering;
mod odds;
mod overview;
mod passage;
mod plans;
mod scene;
mod sessions;
mod strictness;
mod sums;
mod tracking;
mod verdicts;
mod votes;
