//! Passages that have ended: the drives past a sign that had it in view, and have left it behind.

use std::collections::BTreeSet;

use super::expected::{Expecting, Sign, centre_of, is_in_image};
use super::readings::reads_alike;
use crate::domain::anchor::AnchorState;
use crate::domain::change::Keyframe;
use crate::domain::ids::{AnchorSeq, KeyframeSeq, SessionSeq};
use crate::geometry::Point3;
use crate::recognition::map::index::MapIndex;

/// Keyframes of a session that are looked back at, from the one that arrived.
pub const LOOKED_BACK_MAX: usize = 512;
/// And the way that is looked back at, in `distinctive_place_radius_m`.
pub const LOOKED_BACK_RADII: f64 = 4.0;

/// A drive past a sign.
#[derive(Clone, Debug)]
pub struct Passage {
    /// The sign.
    pub sign: Sign,
    /// The keyframes that should have seen it, the newest first.
    pub expecting: Vec<Expecting>,
    /// All keyframes of the drive, the newest first; the one that arrived is the first of them.
    pub drive: Vec<KeyframeSeq>,
}

/// A keyframe that was looked back at, and the way from there to the one that arrived, in metres.
struct Passed<'a> {
    keyframe: &'a Keyframe,
    way_m: f64,
}

/// Returns the passages that a keyframe ends where signs may change, by arriving as the last of its session: of each sign that a keyframe should
/// have seen which is now more than `distinctive_place_radius_m` behind, and none since.
pub fn passages_ended_by(index: &MapIndex, arrived: KeyframeSeq) -> Vec<Passage> {
    let settings = &index.properties().settings;
    if !settings.signs_may_change {
        return Vec::new();
    }
    let radius_m = settings.distinctive_place_radius_m;
    let passed = look_back(index, arrived, radius_m);
    let Some(before) = passed.get(1) else { return Vec::new() };
    let left_behind = (1..passed.len()).filter(|at| {
        let way_m = passed[*at].way_m;
        way_m > radius_m && way_m - before.way_m <= radius_m
    });
    let (mut handled, mut ended) = (BTreeSet::new(), Vec::new());
    for at in left_behind {
        let keyframe = passed[at].keyframe;
        let Some(camera) = &keyframe.camera else { continue };
        let place = keyframe.map_from_camera.centre();
        for root in index.sign_grid().near(keyframe.session, &place) {
            let centre = index.objects().get(root).and_then(|object| centre_of(object, keyframe.session));
            let is_in_view = |centre: &Point3| is_in_image(centre, camera, &keyframe.map_from_camera);
            if !centre.as_ref().is_some_and(is_in_view)
                || handled.contains(&root)
                || has_nothing_to_judge(index, keyframe.session, root, &passed[..=at])
            {
                continue;
            }
            let Some(sign) = Sign::of(index, keyframe.session, root) else { continue };
            if sign.expected_by(keyframe).is_none() {
                continue;
            }
            handled.insert(root);
            if passed[..at].iter().all(|later| sign.expected_by(later.keyframe).is_none()) {
                ended.push(passage(sign, &passed, at, radius_m));
            }
        }
    }
    ended
}

/// Returns the last keyframes of a session, if the one that arrived is the last of them.
fn look_back(index: &MapIndex, arrived: KeyframeSeq, radius_m: f64) -> Vec<Passed<'_>> {
    let (mut passed, mut way_m): (Vec<Passed<'_>>, f64) = (Vec::new(), 0.0);
    if !index.is_last_on_way(arrived) {
        return passed;
    }
    for keyframe in index.way_back(arrived).take(LOOKED_BACK_MAX).filter_map(|seq| index.keyframe(seq)) {
        if let Some(later) = passed.last() {
            way_m += (later.keyframe.map_from_camera.centre() - keyframe.map_from_camera.centre()).norm();
        }
        // The step to the one that arrived may be a long one.
        let from_m = passed.get(1).map_or(way_m, |before| before.way_m);
        if way_m - from_m > LOOKED_BACK_RADII * radius_m {
            break;
        }
        passed.push(Passed { keyframe, way_m });
    }
    passed
}

/// Whether one of these keyframes read a sign as it is called, and nothing spoke against it before.
fn has_nothing_to_judge(
    index: &MapIndex,
    session: SessionSeq,
    root: AnchorSeq,
    passed: &[Passed<'_>],
) -> bool {
    let Some(object) = index.objects().get(root) else { return true };
    let is_doubted = index.misses_of(object).next().is_some() || object.state == AnchorState::Retired;
    !is_doubted && passed.iter().any(|passed| reads_alike(index, object, session, passed.keyframe.seq))
}

/// Returns the passage whose last keyframe that should have seen the sign is at a place of the list.
fn passage(sign: Sign, passed: &[Passed<'_>], last: usize, radius_m: f64) -> Passage {
    let (mut expecting, mut seen_m) = (Vec::new(), passed[last].way_m);
    let mut drive: Vec<KeyframeSeq> = passed[..last].iter().map(|passed| passed.keyframe.seq).collect();
    for earlier in &passed[last..] {
        if earlier.way_m - seen_m > radius_m {
            break;
        }
        drive.push(earlier.keyframe.seq);
        if let Some(expected) = sign.expected_by(earlier.keyframe) {
            expecting.push(expected);
            seen_m = earlier.way_m;
        }
    }
    Passage { sign, expecting, drive }
}
