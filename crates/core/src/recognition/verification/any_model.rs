//! The choice of the model: a similarity where map points are known on both sides, else the images alone.

use super::limits::Limits;
use super::outcome::{Failure, Model, Verification};
use super::similarity::verify;
use super::two_views::verify_two_views;
use super::view::{Landmark, View};
use crate::domain::settings::GeometryModels;
use crate::domain::verdict::GeometryStatus;

/// Verifies one candidate by the first model that can run: a similarity where enough map points are known on both sides,
/// else, if [`Limits::models`] has it so, the images alone. The same values give the same bits, on any thread.
pub fn verify_by_any_model(
    query: &View,
    candidate: &View,
    window: &[Landmark],
    limits: &Limits,
    seed: u64,
) -> Verification {
    let is_triangulated = |view: &View| view.located().len() >= limits.min_matches as usize;
    let by_points = if is_triangulated(query) && is_triangulated(candidate) {
        verify(query, candidate, window, limits, seed)
    } else {
        Verification::skipped(Model::similarity(limits), Failure::TooFewPoints { limit: limits.min_matches })
    };
    if by_points.status != GeometryStatus::Skipped || limits.models == GeometryModels::Sim3 {
        return by_points;
    }
    verify_two_views(query, candidate, limits, seed)
}
