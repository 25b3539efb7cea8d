//! Which anchors hold a map point: when the point moves, their boxes follow.
//!
//! Not the same as asking who observes the point: a detection may name points that its
//! keyframe's `observes` leaves out.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use super::anchor::Shape;
use super::reverse::remove_last;
use crate::domain::ids::{AnchorSeq, PointId, SessionSeq};

/// The anchors by map point.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Holders {
    by_point: HashMap<(SessionSeq, PointId), BTreeSet<AnchorSeq>>,
}

impl Holders {
    /// Returns the anchors that hold a point, ascending.
    pub fn of(&self, session: SessionSeq, id: PointId) -> impl Iterator<Item = AnchorSeq> + '_ {
        self.by_point.get(&(session, id)).into_iter().flatten().copied()
    }

    /// The anchor holds these points as well.
    pub fn hold(&mut self, session: SessionSeq, ids: &[PointId], anchor: AnchorSeq) {
        for id in ids {
            self.by_point.entry((session, *id)).or_default().insert(anchor);
        }
    }

    /// The anchor's shapes were these, and it holds none of their points for now.
    pub fn release(&mut self, shapes: &BTreeMap<SessionSeq, Shape>, anchor: AnchorSeq) {
        for (session, id) in points(shapes) {
            if remove_last(self.by_point.get_mut(&(session, id)), &anchor) {
                self.by_point.remove(&(session, id));
            }
        }
    }

    /// The anchor's shapes are these now.
    pub fn hold_all(&mut self, shapes: &BTreeMap<SessionSeq, Shape>, anchor: AnchorSeq) {
        for point in points(shapes) {
            self.by_point.entry(point).or_default().insert(anchor);
        }
    }
}

fn points(shapes: &BTreeMap<SessionSeq, Shape>) -> impl Iterator<Item = (SessionSeq, PointId)> + '_ {
    shapes.iter().flat_map(|(session, shape)| shape.map_points.iter().map(|id| (*session, *id)))
}
