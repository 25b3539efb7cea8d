//! Eq. (1) of §V-B: x(i, j) = 1 if two anchors have similar descriptions and stand at the same relative place.

use super::anchor_map::LocalAnchor;
use crate::domain::settings::Settings;
use crate::recognition::map::index::TextIndex;
use crate::semantics::{self, Source};

/// Whether x(i, j) = 1, for two anchors whose descriptions are [`similar`].
pub(in crate::recognition) fn x(i: &LocalAnchor, j: &LocalAnchor, settings: &Settings) -> bool {
    same_relative_place(i, j, settings)
}

/// Whether |theta_i - theta_j| < pi/3 and |d_i - d_j| < 1 m, strictly; the angle alone where a distance was assumed.
pub(in crate::recognition) fn same_relative_place(
    a: &LocalAnchor,
    b: &LocalAnchor,
    settings: &Settings,
) -> bool {
    (!a.is_measured_with(b)
        || a.bearing.distance_difference_m(&b.bearing) < settings.anchor_map_max_distance_difference_m)
        && a.bearing.angle_difference_rad(&b.bearing) < settings.anchor_map_max_angle_difference_rad
}

/// Returns the SimilarityLevel of two valid anchors of one class, if it is high enough.
pub(in crate::recognition) fn similar(
    a: &LocalAnchor,
    b: &LocalAnchor,
    texts: &TextIndex,
    settings: &Settings,
) -> Option<(u8, Source)> {
    if a.class != b.class {
        return None;
    }
    if let (Some(a), Some(b)) = (a.text_id, b.text_id) {
        return texts.level(a, b);
    }
    let (level, source) = semantics::similarity_level(a.text.as_deref()?, b.text.as_deref()?);
    (u32::from(level) >= settings.matching_min_similarity_level).then_some((level, source))
}
