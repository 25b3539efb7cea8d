//! Erasing: what leaves for good, with every mark that it left.

pub(super) mod erasure_rows;
pub(super) mod retention_rows;
pub(super) mod traces;
pub(super) mod unsaid;
