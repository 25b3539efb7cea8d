//! Anchors (§IV): from detections to described, merged anchors.

pub mod apply_model_answer;
pub mod association;
pub mod describing;
pub mod description_tasks;
pub mod find_description_tasks;
pub mod ingest;
pub mod loop_closure;
pub(super) mod match_sets;
pub mod matching;
pub(super) mod near_in_meaning;
pub mod observations;
pub mod pairs;
pub mod prior_anchors;
pub mod rejudging;
pub mod session_merge;
