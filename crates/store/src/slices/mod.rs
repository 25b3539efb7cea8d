//! Slices: large deletions and corrections, written in short transactions.

pub(super) mod background;
pub(super) mod deletion;
pub(super) mod fold;
