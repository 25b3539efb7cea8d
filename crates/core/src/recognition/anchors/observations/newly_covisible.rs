//! The pairs of keyframes that changed observations make covisible.
//!
//! Two keyframes have more points in common afterwards only through points whose observers change. These are counted, and not
//! all that the keyframes observe: n keyframes of one place that see the same m points would otherwise cost n² m, whatever
//! the request changes.

use std::collections::BTreeSet;

use crate::domain::change::PointsOfKeyframe;
use crate::domain::ids::{KeyframeSeq, PointId, SessionSeq};
use crate::domain::point_list::PointList;
use crate::recognition::map::index::{Covisibility, MapIndex};

/// The covisibility of some keyframes, before they observe other points.
pub(super) struct CovisibleBefore {
    session: SessionSeq,
    /// The map points that a keyframe observes from now on, or no longer, ascending.
    points: Vec<PointId>,
    observers: Observers,
    keyframes: Vec<KeyframeBefore>,
}

/// One of these keyframes.
struct KeyframeBefore {
    keyframe: KeyframeSeq,
    /// Those of the points that it observed, by their places.
    observed: Vec<usize>,
    along_drive: Vec<KeyframeSeq>,
    /// The keyframes that the client declares covisible from now on.
    declared: Vec<KeyframeSeq>,
}

/// The keyframes that observe each of some points.
struct Observers {
    /// The beginning of each point's list, and the end of the last one.
    begins: Vec<usize>,
    keyframes: Vec<KeyframeSeq>,
}

impl Observers {
    fn of(index: &MapIndex, session: SessionSeq, points: &[PointId]) -> Self {
        let (mut begins, mut keyframes) = (vec![0], Vec::new());
        for point in points {
            keyframes.extend(index.points().sharing(session, [*point]).into_iter().map(|(seq, _)| seq));
            begins.push(keyframes.len());
        }
        Self { begins, keyframes }
    }

    fn at(&self, place: usize) -> &[KeyframeSeq] {
        &self.keyframes[self.begins[place]..self.begins[place + 1]]
    }
}

impl CovisibleBefore {
    /// Notes what the keyframes of a session observe before these changes.
    pub fn of(index: &MapIndex, session: SessionSeq, changed: &[PointsOfKeyframe]) -> Self {
        let observed = |keyframe: KeyframeSeq| index.keyframe(keyframe).map(|stored| &stored.observes);
        let mut points = Vec::new();
        for now in changed {
            let before: BTreeSet<PointId> =
                observed(now.keyframe).into_iter().flat_map(PointList::iter).collect();
            let now: BTreeSet<PointId> = now.observes.iter().collect();
            points.extend(before.symmetric_difference(&now));
        }
        points.sort_unstable();
        points.dedup();
        let keyframes = changed.iter().map(|now| {
            let keyframe = now.keyframe;
            let others = now.declared.iter().flatten().map(|(other, _)| *other);
            KeyframeBefore {
                keyframe,
                observed: places(&points, observed(keyframe).into_iter().flat_map(PointList::iter)),
                along_drive: index.covisibility().along_drive(keyframe),
                declared: others.filter(|other| !index.covisibility().joins(keyframe, *other)).collect(),
            }
        });
        let keyframes = keyframes.collect();
        Self { session, observers: Observers::of(index, session, &points), points, keyframes }
    }

    /// Returns how many pairs of a changed keyframe and an observer there are, summed over the changed points: what it costs to
    /// find who is covisible.
    pub fn pairs(&self, changed: &[PointsOfKeyframe]) -> u64 {
        let mut pairs = 0;
        let mut observers: Vec<u64> =
            (0..self.points.len()).map(|at| self.observers.at(at).len() as u64).collect();
        let places: Vec<Vec<usize>> =
            changed.iter().map(|now| places(&self.points, now.observes.iter())).collect();
        for place in places.iter().flatten() {
            observers[*place] += 1;
        }
        for place in places.iter().chain(self.keyframes.iter().map(|before| &before.observed)).flatten() {
            pairs += observers[*place];
        }
        pairs
    }

    /// Adds the younger keyframe of each pair that is covisible now and was not before.
    pub fn add_younger(&self, index: &MapIndex, found: &mut BTreeSet<KeyframeSeq>) {
        let graph = index.covisibility();
        let observers_now = Observers::of(index, self.session, &self.points);
        let mut gained = vec![0_i64; index.next_keyframe().index()];
        for before in &self.keyframes {
            let keyframe = before.keyframe;
            found.extend(before.declared.iter().map(|other| keyframe.max(*other)));
            let observes = index.keyframe(keyframe).into_iter().flat_map(|stored| stored.observes.iter());
            let now = places(&self.points, observes);
            let observers_before = || before.observed.iter().flat_map(|place| self.observers.at(*place));
            let observers_now = || now.iter().flat_map(|place| observers_now.at(*place));
            for other in observers_before() {
                gained[other.index()] -= 1;
            }
            for other in observers_now() {
                gained[other.index()] += 1;
            }
            // An edge between the two is older, or is one of those declared.
            let is_new = |other: KeyframeSeq, gained: i64| {
                graph.edge(keyframe, other).is_none()
                    && !before.along_drive.contains(&other)
                    && graph.joins(keyframe, other)
                    && !had_enough(graph, (keyframe, other), gained)
            };
            let mut look = |other: KeyframeSeq, gained: i64| {
                let younger = keyframe.max(other);
                if other != keyframe && !found.contains(&younger) && is_new(other, gained) {
                    found.insert(younger);
                }
            };
            for other in graph.along_drive(keyframe) {
                look(other, gained[other.index()]);
            }
            for other in observers_now() {
                let gained = std::mem::take(&mut gained[other.index()]);
                if gained > 0 {
                    look(*other, gained);
                }
            }
            for other in observers_before() {
                gained[other.index()] = 0;
            }
        }
    }
}

/// Whether two keyframes had enough map points in common before they gained so many.
fn had_enough(graph: Covisibility<'_>, (a, b): (KeyframeSeq, KeyframeSeq), gained: i64) -> bool {
    let least = i64::from(graph.enough()) + gained;
    u32::try_from(least).map_or(least < 0, |least| graph.common_points(a, b, least) == least)
}

/// Returns the places of those of some points that are among others, which ascend.
fn places(points: &[PointId], wanted: impl Iterator<Item = PointId>) -> Vec<usize> {
    wanted.filter_map(|point| points.binary_search(&point).ok()).collect()
}
