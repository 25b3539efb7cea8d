//! Jobs: what the writer is asked to do, and about what that costs.

pub(super) mod cost;
pub(super) mod job;
pub(super) mod row_block;
