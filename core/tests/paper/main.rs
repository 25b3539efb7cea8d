//! The paper, asked of the core: a test for each section and for the choices of `docs/method.md`, against numbers computed by hand.

mod candidates;
mod closing;
mod construction;
mod contradiction;
mod differences;
mod distinctive;
mod equation;
mod local_map;
mod matching;
mod scene;
mod strictness;
mod tracking;
mod verdicts;
mod votes;
