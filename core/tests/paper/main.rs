//! The paper, asked of the core: a test for each section and for the choices of `docs/method.md`, against numbers computed by hand.

mod candidates;
mod closing;
mod contradiction;
mod distinctive;
mod equation;
mod matching;
mod scene;
mod tracking;
mod verdicts;
