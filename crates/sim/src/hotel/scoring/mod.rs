//! Scoring: truth, precision and recall, pose errors, and the tables of the paper.

pub mod absolute_pose_error;
pub mod explain;
pub mod fleet;
pub mod paper;
pub mod results;
pub mod score;
pub mod tables;
pub mod truth;
pub mod tum;
