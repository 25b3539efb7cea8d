//! Whether the asked maps show one view in several places: then a view alone says nothing of which.
//!
//! A room that no robot has mapped on this floor may have been mapped on another that looks the same, and nothing rivals it
//! there. So where nothing but views speaks for a place, some keyframes of its session are themselves held against the most
//! promising of the other maps. What is found of them there, an unmapped place may explain of this view as well.

use std::collections::BTreeSet;

use super::explained_cells::cells;
use crate::domain::bow::{BowVector, Score};
use crate::domain::ids::{KeyframeSeq, SessionSeq};
use crate::domain::keyframe::Camera;
use crate::domain::verdict::GeometryStatus;
use crate::recognition::map::index::MapIndex;
use crate::recognition::map::inverted_file::Scratch;
use crate::recognition::verification::Verification;

/// Keyframes that are held against the other maps, at most.
pub const PROBES_MAX: usize = 4;
/// Other maps that they are held against: those whose candidates look most like the question.
pub(in crate::recognition) const RIVAL_MAPS_MAX: usize = 4;
/// Cells of a probe's view that must be explained elsewhere to count: as many as locate a place. Walls and lamps explain fewer
/// anywhere.
pub(in crate::recognition) const ALIKE_FROM_CELLS: usize = 40;
/// A place that no robot has mapped may explain so many times the cells of the best probe of a single view: a probe's view and
/// the one that is found elsewhere are not taken from one spot. Of a drive, several views would have to agree by chance.
pub(in crate::recognition) const SINGLE_VIEW_FACTOR: f64 = 1.3;

/// Returns the maps but one that come first, each once.
pub fn first_others(maps: impl Iterator<Item = usize>, home: usize) -> impl Iterator<Item = usize> {
    let mut seen = BTreeSet::from([home]);
    maps.filter(move |map| seen.insert(*map)).take(RIVAL_MAPS_MAX)
}

/// Returns so many keyframes with a camera, spread evenly over a session by stamp.
pub fn probes(index: &MapIndex, session: SessionSeq, count: usize) -> Vec<KeyframeSeq> {
    let mut of_session: Vec<_> =
        index.keyframes().filter(|found| found.session == session && found.camera.is_some()).collect();
    of_session.sort_by(|a, b| (a.stamp, &a.id).cmp(&(b.stamp, &b.id)));
    let count = of_session.len().min(count);
    // The middle of each of as many parts.
    (0..count).map(|part| of_session[(2 * part + 1) * of_session.len() / (2 * count)].seq).collect()
}

/// Returns the keyframe with a camera whose words are most like a probe's, ties to the smallest id.
pub fn most_alike(index: &MapIndex, bow: &BowVector) -> Option<(KeyframeSeq, Score)> {
    let mut scratch = Scratch::default();
    let scores = index.inverted_file().score_all(bow, &mut scratch);
    let found = scores.iter().filter_map(|(seq, score)| {
        let stored = index.keyframe(KeyframeSeq(seq))?;
        stored.camera.is_some().then_some((stored, score))
    });
    let best = found.max_by(|(a, score_a), (b, score_b)| {
        score_a.units().cmp(&score_b.units()).then_with(|| b.id.cmp(&a.id))
    });
    best.filter(|(_, score)| score.units() > 0).map(|(stored, score)| (stored.seq, score))
}

/// Returns how many cells of a probe's view the other keyframe explains; 0 where geometry did not verify, or they are too few to
/// count.
pub fn alike_cells(verification: &Verification, probe: &Camera, other: &Camera) -> usize {
    let [in_probe, in_other] = &verification.explained_pixels;
    match verification.status {
        GeometryStatus::Verified => {
            let common = cells(0, probe, in_probe).len().min(cells(0, other, in_other).len());
            if common >= ALIKE_FROM_CELLS { common } else { 0 }
        }
        _ => 0,
    }
}
