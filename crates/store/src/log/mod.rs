//! The log: what versions of a map said and replaced, in their order, which its rows do not tell.
//!
//! | concept | file |
//! |---|---|
//! | what is kept of a version, and its form | [`entry`] |
//! | which changes a version keeps | [`super::commit::said`] |
//! | parts, and how poses and points of a large correction are cut into them | [`parts`] |
//! | its rows | [`log_rows`] |
//!
//! Rows hold a map as it stands. Beside them a version has a part 0 here if it said something that they do not tell: a correction,
//! a loop, a description by hand, new properties. Keyframes and their detections are in their rows as they were sent, so that a
//! version which brings one mostly has none. Further parts hold the poses and points of a large correction; they are written
//! first, and count from the moment that the version's part 0 is there. Until [`super::slices::fold`] has brought them into the
//! rows, they are what stands.

pub(super) mod entry;
pub(super) mod log_rows;
pub(super) mod parts;
