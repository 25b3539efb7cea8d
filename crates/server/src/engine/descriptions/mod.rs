//! Descriptions: background work of foundation models (§IV-A.1).

pub(super) mod backlog;
pub(super) mod description_job;
pub(super) mod judgement_runner;
pub(super) mod round;
pub(super) mod running_jobs;
pub(super) mod unexamined;
pub(super) mod worker;
