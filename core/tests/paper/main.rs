//! The paper, asked of the core: a test for each section and for the choices of `docs/method.md`, against numbers computed by hand.

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
mod scene;
mod sessions;
mod strictness;
mod tracking;
mod verdicts;
mod votes;
mod witness;
