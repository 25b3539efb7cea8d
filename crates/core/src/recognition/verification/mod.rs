//! §V, the last step: the transformation between two keyframes, and how many features match under it.
//!
//! | step | file |
//! |---|---|
//! | points that their own image has elsewhere | [`resection`] |
//! | match descriptors | [`descriptor_matching`], `group_matching`, [`orientation`] |
//! | points with positions on both sides: find a similarity most of them agree with | [`similarity`], [`ransac`], [`correspondence`] |
//! | refine it on the reprojection errors; how well it is known | [`refinement`], `normal_equations`, `huber`, [`covariance`] |
//! | a flat patch may be tilted the other way | [`planar_ambiguity`] |
//! | project, match again, count | [`guided_search`], `projection_search`, [`keypoint_grid`] |
//! | too few points with positions: images alone | [`two_views`] |
//! | how often chance explains as much | [`significance`] |
//! | the first model that can run | `any_model` |
//! | what is compared | [`view`] |
//! | what comes out | [`outcome`] |
//! | the thresholds | [`limits`] |
//!
//! The steps are those of ORB-SLAM3's loop detection (C. Campos et al., T-RO 2021). Unlike there, a point must lie in
//! front of both cameras, thresholds are not truncated to integers, degenerate samples are refused, random numbers come
//! from a seed, and points that only the neighbours of the candidate saw count.

mod any_model;
pub mod correspondence;
pub mod covariance;
pub mod descriptor_match;
pub mod descriptor_matching;
mod group_matching;
pub mod guided_search;
mod huber;
pub mod keypoint_grid;
pub mod limits;
mod normal_equations;
pub mod orientation;
pub mod outcome;
pub mod planar_ambiguity;
mod projection_search;
pub mod ransac;
pub mod refinement;
pub mod resection;
pub mod significance;
pub mod similarity;
pub mod two_views;
pub mod view;

pub use any_model::verify_by_any_model;
pub use limits::{GuidedLimits, Limits, MatchingLimits, SamplingLimits, SureLimits};
pub use outcome::{Failure, Model, Verification};
pub use similarity::verify;
pub use view::{Landmark, View};

#[cfg(test)]
mod tests;
