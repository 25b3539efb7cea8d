//! The map points of every session: where they are, and who observes them.

use std::collections::{BTreeMap, HashMap};

use crate::geometry::Point3;
use crate::model::ids::{KeyframeSeq, PointId, SessionSeq};

/// One map point. It may be observed before it has a position (not triangulated yet), and
/// have a position before anyone observes it.
#[derive(Clone, Debug, Default, PartialEq)]
struct MapPoint {
    position_in_session: Option<Point3>,
    /// Ascending.
    observers: Vec<KeyframeSeq>,
}

/// All map points of a map; numbers collide between sessions on purpose.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Points {
    by_session: HashMap<(SessionSeq, PointId), MapPoint>,
    /// How many have a position.
    placed: u64,
}

/// What a map point with a position takes on disk, in bytes: its number and three floats.
pub const POINT_BYTES: u64 = (size_of::<PointId>() + 3 * size_of::<f64>()) as u64;

impl Points {
    /// The point's position in its session's frame, if it has one.
    pub fn position(&self, session: SessionSeq, id: PointId) -> Option<Point3> {
        self.by_session.get(&(session, id))?.position_in_session
    }

    /// How many there are, with and without a position.
    pub fn len(&self) -> usize {
        self.by_session.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.by_session.is_empty()
    }

    /// What the points that have a position take on disk, in bytes. Those without one are numbers in keyframes.
    pub fn bytes(&self) -> u64 {
        self.placed * POINT_BYTES
    }

    /// The keyframes that observe the point, ascending.
    pub fn observers(&self, session: SessionSeq, id: PointId) -> &[KeyframeSeq] {
        self.by_session.get(&(session, id)).map_or(&[], |point| &point.observers)
    }

    /// The keyframes that observe some of these points, each with how many.
    pub fn sharing(&self, session: SessionSeq, ids: &[PointId]) -> BTreeMap<KeyframeSeq, u32> {
        let mut shared = BTreeMap::new();
        for observer in ids.iter().flat_map(|id| self.observers(session, *id)) {
            *shared.entry(*observer).or_default() += 1;
        }
        shared
    }

    /// The point is here now.
    pub fn set_position(&mut self, session: SessionSeq, id: PointId, position_in_session: Point3) {
        let point = self.by_session.entry((session, id)).or_default();
        let before = point.position_in_session.replace(position_in_session);
        self.placed += u64::from(before.is_none());
    }

    /// The point has no position any more.
    pub fn clear_position(&mut self, session: SessionSeq, id: PointId) {
        if let Some(point) = self.by_session.get_mut(&(session, id)) {
            self.placed -= u64::from(point.position_in_session.take().is_some());
            if point.observers.is_empty() {
                self.by_session.remove(&(session, id));
            }
        }
    }

    /// A keyframe observes these points.
    pub fn observe(&mut self, session: SessionSeq, ids: &[PointId], keyframe: KeyframeSeq) {
        for id in ids {
            let observers = &mut self.by_session.entry((session, *id)).or_default().observers;
            if let Err(at) = observers.binary_search(&keyframe) {
                observers.insert(at, keyframe);
            }
        }
    }

    /// A keyframe that observed these points is gone. A point that has no position and that
    /// nobody observes is no fact of the map any more.
    pub fn forget(&mut self, session: SessionSeq, ids: &[PointId], keyframe: KeyframeSeq) {
        for id in ids {
            if let Some(point) = self.by_session.get_mut(&(session, *id)) {
                point.observers.retain(|observer| *observer != keyframe);
                if point.observers.is_empty() && point.position_in_session.is_none() {
                    self.by_session.remove(&(session, *id));
                }
            }
        }
    }
}
