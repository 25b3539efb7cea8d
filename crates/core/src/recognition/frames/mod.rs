//! One frame for all sessions, from confirmed loops and plans, and the loops that contradict the rest (M60).
//!
//! A loop that was verified by geometry says where two sessions lie to each other. Some of them are false, and the frames must
//! not follow those:
//!
//! 1. Loops between the same two sessions agree with each other as far as tracking can have drifted from one to the other
//!    ([`consensus`]; pairwise consistency, Mangelson et al., ICRA 2018).
//! 2. The largest agreeing sets join the sessions to a tree, which is where the search begins ([`tree`]).
//! 3. All loops of these sets refine the frames, and those that contradict the cycles lose their weight ([`refinement`];
//!    graduated non-convexity, Yang et al., RA-L 2020).
//! 4. What does not agree with the frames is a suspect, with the cycle that shows it ([`cycle`]).
//!
//! Frames are rigid: what tracking drifted within a session stays, and shows as the residual.

pub mod consensus;
pub mod cycle;
pub mod fleet;
pub mod measurement;
pub mod pose_graph;
pub mod refinement;
pub mod tree;

#[cfg(test)]
mod tests;
