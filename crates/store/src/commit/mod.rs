//! Commits: one writer, a fair queue before it, and group commit.

pub(super) mod additions;
pub(super) mod commit_queue;
mod group;
pub(super) mod group_commit;
pub(super) mod health;
mod held;
pub(super) mod lanes;
pub(super) mod own_disk;
pub(super) mod queue;
pub(super) mod renewal;
pub(super) mod said;
pub(super) mod staging;
pub(super) mod write;
