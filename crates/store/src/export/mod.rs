//! Export: what a map was sent, operation by operation, in the order of writing.
//!
//! | concept | file |
//! |---|---|
//! | the order of operations, and what is left out of them | [`operation_reader`] |
//! | poses and positions as they were at each version | [`history`] |
//! | corrections | [`correction`] |
//! | merges of sessions | [`merge`], [`merges`] |
//! | one keyframe as it was sent | [`keyframe`], [`introduced`] |
//!
//! Deleted keyframes are left out, with all that hangs on them. All is read in one read transaction: one version of the map.

mod correction;
mod history;
mod introduced;
mod keyframe;
mod merge;
mod merges;
mod operation_reader;

pub use operation_reader::Export;
