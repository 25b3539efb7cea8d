//! Columns: how values lie in them, packed or not.

pub(super) mod blob;
pub(super) mod bulk_insert;
pub(super) mod clock;
pub(super) mod column;
pub(super) mod json;
pub(super) mod keypoints;
pub(super) mod values;
