//! Object tracking: which anchor a detection is one more sight of (§IV-C.1).
//!
//! A detection z_i of keyframe k may belong to an anchor of its class that some keyframe of
//! K_k^cov has observed. It does if the anchor's box covers at least a share sigma of its map
//! points P_i. Choices the paper leaves open (M3):
//!
//! - At most one detection of a keyframe feeds an anchor; the largest share wins, then the older anchor.
//! - Only map points with a position count. A detection of which no point is triangulated yet
//!   is held against the anchor's own points instead, so that it does not found a twin.
//! - A detection with only a `position` joins the nearest anchor within `association_position_radius_m`.

use std::collections::BTreeSet;

use crate::domain::anchor::{AnchorState, IgnoredReason};
use crate::domain::change::{Merge, MergeCause};
use crate::domain::ids::{AnchorSeq, KeyframeSeq, PointId, SessionSeq};
use crate::domain::keyframe::Detection;
use crate::geometry::Point3;
use crate::recognition::map::index::{MapIndex, MergedAnchor, Shape};
use crate::semantics::{self, Text};

/// What becomes of a detection.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Association {
    /// It is one more sight of this object (named by its oldest anchor).
    Tracked(AnchorSeq),
    /// It is something not seen before by the covisible keyframes.
    New,
    /// It feeds no anchor.
    Ignored(IgnoredReason),
}

/// A possible pair, ordered from the best: anchors that hang there before retired ones, shares before distances, large
/// shares and short distances first, then the older anchor, then the earlier detection.
#[derive(Clone, Copy, Debug)]
struct Pair {
    /// A retired anchor takes what no other does.
    is_retired: bool,
    /// The share of covered map points, or the negated distance in metres.
    closeness: f64,
    by_points: bool,
    object: AnchorSeq,
    detection: usize,
}

/// Associates the detections of a keyframe of this session with the objects that the keyframes of
/// `covisible` (K_k^cov) have seen. `position` tells where a map point of the session is, if it
/// is triangulated.
pub fn associate(
    index: &MapIndex,
    session: Option<SessionSeq>,
    covisible: impl Iterator<Item = KeyframeSeq>,
    detections: &[Detection],
    position: impl Fn(PointId) -> Option<Point3>,
) -> Vec<Association> {
    let properties = index.properties();
    let mut outcome: Vec<Association> = detections
        .iter()
        .map(|detection| {
            if !properties.anchors_class(&detection.class) {
                Association::Ignored(IgnoredReason::ClassNotAnchored)
            } else if detection.map_points.is_empty() && detection.position_in_session.is_none() {
                Association::Ignored(IgnoredReason::NoPlace)
            } else {
                Association::New
            }
        })
        .collect();
    // A session's first keyframe has nothing in its frame to be held against.
    let Some(session) = session else { return outcome };
    let nearby: BTreeSet<AnchorSeq> =
        covisible.flat_map(|keyframe| index.objects_seen_by(keyframe)).collect();
    let mut pairs = Vec::new();
    for (number, detection) in detections.iter().enumerate() {
        if outcome[number] != Association::New {
            continue;
        }
        let sight = Sight::of(&detection.map_points, detection.position_in_session, &position);
        for root in &nearby {
            let Some(object) = index.objects().get(*root) else { continue };
            if index.class_of(object) != detection.class {
                continue;
            }
            let is_retired = object.state == AnchorState::Retired;
            if is_retired && excludes(index, object, detection) {
                continue;
            }
            let shape = object.shapes.get(&session);
            if let Some((closeness, by_points)) = closeness(index, &sight, shape) {
                pairs.push(Pair { is_retired, closeness, by_points, object: *root, detection: number });
            }
        }
    }
    pairs.sort_by(|a, b| {
        (a.is_retired.cmp(&b.is_retired))
            .then_with(|| b.by_points.cmp(&a.by_points))
            .then_with(|| b.closeness.total_cmp(&a.closeness))
            .then_with(|| a.object.cmp(&b.object))
            .then_with(|| a.detection.cmp(&b.detection))
    });
    let mut taken = BTreeSet::new();
    for pair in pairs {
        if outcome[pair.detection] == Association::New && taken.insert(pair.object) {
            outcome[pair.detection] = Association::Tracked(pair.object);
        }
    }
    outcome
}

/// Whether a detection was read as another sign than an object: it hangs in its place.
fn excludes(index: &MapIndex, object: &MergedAnchor, detection: &Detection) -> bool {
    let text = object.description.as_ref().map(|description| &description.text);
    let numbering = index.readings().numbering(&detection.class);
    let read = detection.reading().map(|reading| Text::under(reading, numbering));
    text.zip(read).is_some_and(|(text, read)| semantics::is_conflict(text, &read))
}

/// Returns a merge of an anchor that a stored keyframe founded with an object that earlier keyframes saw, if it is one more
/// sight of that: by what these keyframes observe now, and of the object what they had seen of it.
pub fn late_sight(index: &MapIndex, keyframe: KeyframeSeq) -> Option<Merge> {
    let stored = index.keyframe(keyframe)?;
    let is_founded = |seq: &AnchorSeq| {
        let first = index.anchor(*seq).and_then(|anchor| anchor.observations.keys().next());
        first.is_some_and(|(first, _)| *first == keyframe)
    };
    let mut founded = index.anchors_seen_by(keyframe).filter(is_founded).peekable();
    founded.peek()?;
    // A loop that was confirmed since says nothing of what the keyframe knew.
    let graph = index.covisibility();
    let earlier: Vec<KeyframeSeq> =
        graph.neighbours_by_sight(keyframe).filter(|other| *other < keyframe).collect();
    let mut nearby = index.objects_seen_by_any(&earlier);
    let own = index.objects_seen_by(keyframe);
    nearby.retain(|root| !own.contains(root));
    let position = |point| index.points().position(stored.session, point);
    let mut pairs = Vec::new();
    for seq in founded {
        let Some((anchor, root)) = index.anchor(seq).zip(index.objects().root(seq)) else { continue };
        let Some(observation) = anchor.observations.values().next() else { continue };
        let Some(mine) = index.objects().get(root) else { continue };
        let seen_at = observation.position_as_sent.map(|sent| stored.position_now(sent));
        let sight = Sight::of(&observation.map_points, seen_at, position);
        for other in &nearby {
            let Some(theirs) = index.objects().get(*other) else { continue };
            if *index.class_of(theirs) != *anchor.class || theirs.state == AnchorState::Retired {
                continue;
            }
            let shape = index.shape_before(theirs, stored.session, keyframe);
            let Some((closeness, by_points)) = closeness(index, &sight, shape.as_ref()) else { continue };
            if index.keyframes_of(theirs).is_disjoint(&index.keyframes_of(mine)) {
                pairs.push((by_points, closeness, *other, root));
            }
        }
    }
    let best = pairs.into_iter().max_by(|a, b| {
        a.0.cmp(&b.0).then_with(|| a.1.total_cmp(&b.1)).then_with(|| (b.2, b.3).cmp(&(a.2, a.3)))
    });
    best.map(|(_, _, a, b)| Merge { into: a.min(b), from: a.max(b), cause: MergeCause::Covisible })
}

/// The place of a detection.
struct Sight<'d> {
    points: &'d [PointId],
    /// The places of those points that are triangulated. Looked up once: it is held against every object nearby.
    placed: Vec<Point3>,
    /// In the frame of its keyframe's session.
    position: Option<Point3>,
}

impl<'d> Sight<'d> {
    fn of(
        points: &'d [PointId],
        position: Option<Point3>,
        place: impl Fn(PointId) -> Option<Point3>,
    ) -> Self {
        Self { points, placed: points.iter().filter_map(|id| place(*id)).collect(), position }
    }
}

/// Returns how well a detection fits an object of this shape in its session, if it fits at all; and whether map points say
/// so.
fn closeness(index: &MapIndex, sight: &Sight<'_>, shape: Option<&Shape>) -> Option<(f64, bool)> {
    let settings = &index.properties().settings;
    let shape = shape?;
    if let Some(share) = covered_share(sight, shape) {
        return (share > 0.0 && share >= settings.association_min_point_share).then_some((share, true));
    }
    let distance_m = (sight.position? - shape.aabb?.centre()).norm();
    (distance_m <= settings.association_position_radius_m).then_some((-distance_m, false))
}

/// Returns the share of a detection's map points that an object's box covers; `None` if map points cannot tell.
fn covered_share(sight: &Sight<'_>, shape: &Shape) -> Option<f64> {
    let Sight { points, placed, .. } = sight;
    if !placed.is_empty() {
        let aabb = shape.aabb?;
        let covered = placed.iter().filter(|point| aabb.contains(point)).count();
        return Some(covered as f64 / placed.len() as f64);
    }
    let own = points.iter().filter(|id| shape.map_points.contains(id)).count();
    (own > 0).then(|| own as f64 / points.len() as f64)
}
