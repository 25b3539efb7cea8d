//! Observations: what the client's map did to points and edges after it had sent the keyframes (`openapi/openapi.yaml`).

use std::collections::{HashMap, HashSet};

use revisit_core::domain::ids::{KeyframeId, PointId, SessionId};
use revisit_core::domain::request::{self, ChangedObservations};
use revisit_shapes::{answer, body};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::decoding::column::{Column, Number, Packed};
use super::decoding::read::{Decode, Members as _, Node};
use super::keyframe::{CovisibleShape, ascending, covisible, filled, named_once, others_than};
use super::limits;
use super::shown::Shown;

/// Changes that a robot's map made to its points and edges; all of it is taken over, or nothing. Everything in it is of one session.
#[body(ChangedObservations, of = ChangedObservations)]
pub struct ObservationsBody {
    /// The session.
    #[schema(default = "default")]
    #[id]
    #[from(Some(of.session))]
    pub session: Option<SessionId>,
    /// Fused map points, `[old, new]` each: who observed the old one observes the new one from now on. The new one keeps its
    /// position, or takes the old one's. No point is fused twice; `[1,2]` and `[2,3]` make both of them 3.
    #[schema(max_items = 10_000, inline)]
    #[read(fused)]
    #[from(filled(of.replaced))]
    pub replaced: Option<Vec<FusedPoints>>,
    /// Culled map points: nobody observes them any more.
    #[schema(max_items = 10_000, minimum = 0)]
    #[read(|node| culled(node, replaced.as_ref()))]
    #[from(filled(of.removed))]
    pub removed: Option<Vec<i64>>,
    /// Keyframes of the session of which there is more to say, none twice.
    #[schema(max_items = 1_000, value_type = Option<Vec<ChangedKeyframe>>)]
    #[read(|node| changed_keyframes(node, replaced.as_ref(), removed.as_ref()))]
    #[from(filled(of.keyframes))]
    pub keyframes: Option<Vec<ChangedKeyframeShape>>,
}

/// Two map points that are one: the number that goes, and the number that stays.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(transparent)]
#[schema(value_type = Vec<i64>, min_items = 2, max_items = 2, minimum = 0)]
pub struct FusedPoints(pub [PointId; 2]);

/// The map points and covisible keyframes of a keyframe, as the robot's map has them now.
#[body(sent ChangedKeyframe, of = request::ChangedKeyframe)]
#[schema(as = ChangedKeyframeLists)]
pub struct ChangedKeyframeShape {
    /// The keyframe.
    #[id]
    pub keyframe: KeyframeId,
    /// All map points that it observes, those of its features included; a feature whose point is not listed observes none.
    /// Left out: what it observed, as far as points were not fused or culled.
    #[schema(max_items = 100_000, minimum = 0)]
    #[column(observes_i64, I64)]
    pub observes: Option<Vec<i64>>,
    /// Covisible keyframes besides those declared before, or with another number of shared points; each must exist.
    #[schema(max_items = 10_000)]
    #[read(|node| others(node, keyframe.as_ref()))]
    #[from(filled(of.covisible))]
    pub covisible: Option<Vec<CovisibleShape>>,
}

/// The map follows the robot's.
#[answer]
#[derive(Copy)]
pub struct ObservationsAnswer {
    /// The map's version after it.
    pub map_version: u64,
    /// Number of keyframes that observe other points now, or have other declared neighbours.
    pub keyframes: usize,
    /// Number of map points that were there and are gone, fused or culled.
    pub map_points: usize,
    /// Number of anchors that turned out to be one with another.
    pub anchors_merged: usize,
}

impl Shown<(PointId, PointId)> for FusedPoints {
    fn shown((old, new): (PointId, PointId)) -> Self {
        Self([old, new])
    }
}

impl Decode for FusedPoints {
    fn decode(node: &Node<'_>) -> Option<Self> {
        let numbers = node.list(2, |point| point.whole(limits::POINT))?;
        let Ok(points) = numbers.try_into() else { return node.refuse("not two map points", "[old, new]") };
        Some(Self(points))
    }
}

const OBSERVES: Column = Column {
    list: "observes",
    packed: Some(Packed { name: "observes_i64", number: Number::I64, row: None }),
};

/// A member as it was read: `None` if it is wrong, `Some(None)` if it is missing.
type Read<'r, T> = Option<&'r Option<Vec<T>>>;

fn fused(node: &Node<'_>) -> Option<Vec<FusedPoints>> {
    let (mut fused, mut ends) = (HashSet::new(), Ends::default());
    node.list(limits::FUSED_POINTS, |pair| {
        let points @ FusedPoints([old, new]) = FusedPoints::decode(pair)?;
        if !fused.insert(old) {
            return pair.refuse("this map point is replaced twice", "each one once");
        }
        // Whoever follows a point that is replaced must come to one that stays.
        if ends.of(new) == old {
            return pair.refuse("this map point is replaced by itself", "another map point");
        }
        ends.after.insert(old, new);
        Some(points)
    })
}

fn goes(replaced: Read<'_, FusedPoints>) -> HashSet<PointId> {
    replaced.into_iter().flatten().flatten().map(|FusedPoints([old, _])| *old).collect()
}

fn culled(node: &Node<'_>, replaced: Read<'_, FusedPoints>) -> Option<Vec<PointId>> {
    let fused = goes(replaced);
    node.unique(limits::FUSED_POINTS, |point| {
        let id = point.whole(limits::POINT)?;
        if fused.contains(&id) {
            return point.refuse("this map point is replaced, too", "one of the two");
        }
        Some(id)
    })
}

fn changed_keyframes(
    node: &Node<'_>,
    replaced: Read<'_, FusedPoints>,
    removed: Read<'_, PointId>,
) -> Option<Vec<ChangedKeyframeShape>> {
    let mut gone = goes(replaced);
    gone.extend(removed.into_iter().flatten().flatten());
    let mut names = HashSet::new();
    node.list(limits::CHANGED_KEYFRAMES, |entry| {
        let changed = named_once(entry, &mut names, ChangedKeyframeShape::decode)?;
        if changed.observes.iter().flatten().any(|point| gone.contains(point)) {
            let object = entry.object(&ChangedKeyframeShape::names())?;
            object.optional_column(OBSERVES, |node| {
                node.each(limits::MAP_POINTS, |_, point| stays(point, &gone))
            })?;
        }
        Some(changed)
    })
}

fn stays(point: &Node<'_>, gone: &HashSet<PointId>) -> Option<()> {
    if gone.contains(&point.whole(limits::POINT)?) {
        return point.refuse("this request replaces or removes this map point", "a map point that stays");
    }
    Some(())
}

fn others(node: &Node<'_>, keyframe: Option<&KeyframeId>) -> Option<Vec<CovisibleShape>> {
    let others = others_than(node, keyframe);
    (covisible(node).zip(others)).map(|(listed, ())| listed)
}

impl From<ObservationsBody> for ChangedObservations {
    fn from(body: ObservationsBody) -> Self {
        let changed = |of: ChangedKeyframeShape| request::ChangedKeyframe {
            keyframe: of.keyframe,
            observes: of.observes.map(ascending),
            covisible: of.covisible.into_iter().flatten().map(|of| (of.keyframe, of.shared)).collect(),
        };
        Self {
            session: body.session.unwrap_or_default(),
            replaced: body.replaced.into_iter().flatten().map(|FusedPoints([old, new])| (old, new)).collect(),
            removed: body.removed.unwrap_or_default(),
            keyframes: body.keyframes.into_iter().flatten().map(changed).collect(),
        }
    }
}

/// The ends of replaced points. Each search shortens the ways that it went, so that no chain is followed again and again.
#[derive(Default)]
struct Ends {
    after: HashMap<PointId, PointId>,
}

impl Ends {
    fn of(&mut self, point: PointId) -> PointId {
        let (mut way, mut end) = (Vec::new(), point);
        while let Some(after) = self.after.get(&end) {
            way.push(end);
            end = *after;
        }
        self.after.extend(way.into_iter().map(|passed| (passed, end)));
        end
    }
}
