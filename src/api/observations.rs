//! Observations: what the client's map did to points and edges after it had sent the keyframes (`openapi/openapi.yaml`).

use std::collections::{HashMap, HashSet};

use revisit_shapes::answer;
use utoipa::ToSchema;

use super::decoding::read::{self, Decode, Node};
use super::keyframe::{CovisibleShape, OBSERVES, PointNumber, ascending, covisible, unique};
use super::limits;
use crate::domain::ids::{KeyframeId, PointId, SessionId};
use crate::domain::request::{ChangedKeyframe, ChangedObservations};

/// Changes that a robot's map made to its points and edges; all of it is taken over, or nothing. Everything in it is of one session.
#[answer]
#[serde(deny_unknown_fields)]
pub struct ObservationsBody {
    /// The session.
    #[schema(
        default = "default",
        min_length = 1,
        max_length = 128,
        pattern = r"^(\.{0,2}[A-Za-z0-9_:-]|\.{3})[A-Za-z0-9._:-]*$"
    )]
    pub session: Option<String>,
    /// Fused map points, `[old, new]` each: who observed the old one observes the new one from now on. The new one keeps its
    /// position, or takes the old one's. No point is fused twice; `[1,2]` and `[2,3]` make both of them 3.
    #[schema(max_items = 10_000, value_type = Option<Vec<FusedPoints>>, inline)]
    pub replaced: Option<Vec<Vec<i64>>>,
    /// Culled map points: nobody observes them any more.
    #[schema(max_items = 10_000, value_type = Option<Vec<PointNumber>>, inline)]
    pub removed: Option<Vec<i64>>,
    /// Keyframes of the session of which there is more to say, none twice.
    #[schema(max_items = 1_000)]
    pub keyframes: Option<Vec<ChangedKeyframeShape>>,
}

/// Two map points that are one: the number that goes, and the number that stays.
#[derive(ToSchema)]
#[schema(min_items = 2, max_items = 2)]
pub struct FusedPoints(
    #[expect(dead_code, reason = "a schema only")]
    #[schema(inline)]
    Vec<PointNumber>,
);

/// The map points and covisible keyframes of a keyframe, as the robot's map has them now.
#[answer]
#[serde(deny_unknown_fields)]
#[schema(as = ChangedKeyframe)]
pub struct ChangedKeyframeShape {
    /// The keyframe.
    #[schema(min_length = 1, max_length = 128, pattern = r"^(\.{0,2}[A-Za-z0-9_:-]|\.{3})[A-Za-z0-9._:-]*$")]
    pub keyframe: String,
    /// All map points that it observes, those of its features included; a feature whose point is not listed observes none.
    /// Left out: what it observed, as far as points were not fused or culled.
    #[schema(max_items = 100_000, value_type = Option<Vec<PointNumber>>, inline)]
    pub observes: Option<Vec<i64>>,
    /// The same, packed: base64 of little-endian 64-bit signed numbers.
    #[schema(max_length = 1_066_668)]
    pub observes_i64: Option<String>,
    /// Covisible keyframes besides those declared before, or with another number of shared points; each must exist.
    #[schema(max_items = 10_000)]
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

impl Decode for ChangedObservations {
    fn decode(node: &Node<'_>) -> Option<Self> {
        let body = node.object(&["session", "replaced", "removed", "keyframes"])?;
        let session = body.optional("session", read::id::<SessionId>);
        let replaced = body.optional("replaced", replaced);
        let fused: HashSet<PointId> =
            replaced.iter().flatten().flatten().map(|(old, _): &(PointId, PointId)| *old).collect();
        let removed = body.optional("removed", |node| {
            unique(node, limits::FUSED_POINTS, |point| {
                let id = point.whole(limits::POINT)?;
                if fused.contains(&id) {
                    return point.refuse("this map point is replaced, too", "one of the two");
                }
                Some(id)
            })
        });
        let culled: HashSet<PointId> = removed.iter().flatten().flatten().copied().collect();
        let mut names = HashSet::new();
        let keyframes = body.optional("keyframes", |node| {
            node.list(limits::CHANGED_KEYFRAMES, |entry| {
                changed_keyframe(entry, &mut names, |id| fused.contains(&id) || culled.contains(&id))
            })
        });
        Some(Self {
            session: session?.unwrap_or_default(),
            replaced: replaced?.unwrap_or_default(),
            removed: removed?.unwrap_or_default(),
            keyframes: keyframes?.unwrap_or_default(),
        })
    }
}

fn replaced(node: &Node<'_>) -> Option<Vec<(PointId, PointId)>> {
    let (mut fused, mut ends) = (HashSet::new(), Ends::default());
    node.list(limits::FUSED_POINTS, |pair| {
        let numbers = pair.list(2, |point| point.whole(limits::POINT))?;
        let [old, new] = numbers[..] else {
            return pair.refuse("not two map points", "[old, new]");
        };
        if !fused.insert(old) {
            return pair.refuse("this map point is replaced twice", "each one once");
        }
        // Whoever follows a point that is replaced must come to one that stays.
        if ends.of(new) == old {
            return pair.refuse("this map point is replaced by itself", "another map point");
        }
        ends.after.insert(old, new);
        Some((old, new))
    })
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

fn changed_keyframe(
    entry: &Node<'_>,
    names: &mut HashSet<KeyframeId>,
    is_gone: impl Fn(PointId) -> bool,
) -> Option<ChangedKeyframe> {
    let body = entry.object(&["keyframe", OBSERVES.list, OBSERVES.packed, "covisible"])?;
    let keyframe = body.required("keyframe", |node| {
        let keyframe: KeyframeId = read::id(node)?;
        if !names.insert(keyframe.clone()) {
            return node.refuse("the keyframe is listed twice", "each keyframe once");
        }
        Some(keyframe)
    });
    let observes = body.optional_column(OBSERVES, |node| {
        node.list(limits::MAP_POINTS, |point| {
            let id = point.whole(limits::POINT)?;
            if is_gone(id) {
                return point
                    .refuse("this request replaces or removes this map point", "a map point that stays");
            }
            Some(id)
        })
    });
    let covisible = body.optional("covisible", |node| covisible(node, keyframe.as_ref()));
    let (observes, covisible) = (observes?, covisible?);
    Some(ChangedKeyframe {
        keyframe: keyframe?,
        observes: observes.map(ascending),
        covisible: covisible.unwrap_or_default(),
    })
}

impl From<ChangedObservations> for ObservationsBody {
    fn from(changed: ChangedObservations) -> Self {
        let ChangedObservations { session, replaced, removed, keyframes } = changed;
        let keyframe = |of: ChangedKeyframe| ChangedKeyframeShape {
            keyframe: of.keyframe.to_string(),
            observes: of.observes,
            observes_i64: None,
            covisible: (!of.covisible.is_empty()).then(|| {
                let shape = |(keyframe, shared): (KeyframeId, u32)| CovisibleShape {
                    keyframe: keyframe.to_string(),
                    shared,
                };
                of.covisible.into_iter().map(shape).collect()
            }),
        };
        let pair = |(old, new): (PointId, PointId)| vec![old, new];
        Self {
            session: Some(session.to_string()),
            replaced: (!replaced.is_empty()).then(|| replaced.into_iter().map(pair).collect()),
            removed: (!removed.is_empty()).then_some(removed),
            keyframes: (!keyframes.is_empty()).then(|| keyframes.into_iter().map(keyframe).collect()),
        }
    }
}
