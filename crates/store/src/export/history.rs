//! History: a map's poses and points as they were at any version, from the first to the last.
//!
//! Rows hold what stands now. The log says of each value that was replaced what stood before, and what was set. A first pass takes
//! the values that stood before the log tells of them; from there on each version sets its own. So memory holds each replaced
//! value once, however often it was replaced.

use std::collections::{HashMap, HashSet, VecDeque};

use revisit_core::domain::change::Change;
use revisit_core::domain::former::FormerValues;
use revisit_core::domain::ids::{KeyframeSeq, PointId, SessionSeq};
use revisit_core::geometry::{Point3, Pose, Sim3};

use crate::StoreError;
use crate::loading::deferred;
use crate::log::entry::Entry;
use crate::log::log_rows;
use crate::map_key::MapKey;
use crate::rows::point_blocks;
use crate::sql::{self, Connection};

/// The coordinates of a point that is not there.
const ABSENT: [f64; 3] = [f64::NAN; 3];

type Point = (SessionSeq, PointId);

/// Values that are not those of their rows.
#[derive(Default)]
struct Values {
    poses: HashMap<KeyframeSeq, Sim3>,
    points: HashMap<Point, [f64; 3]>,
}

impl Values {
    fn apply(&mut self, change: &Change) {
        match change {
            Change::PoseSet(keyframe, pose) => drop(self.poses.insert(*keyframe, *pose)),
            Change::PointSet(session, id, at) => {
                self.points.insert((*session, *id), [at.x, at.y, at.z]);
            }
            Change::PointsForgotten(session, ids) => {
                self.points.extend(ids.iter().map(|id| ((*session, *id), ABSENT)));
            }
            _ => {}
        }
    }
}

/// A value that stands in the end and that no version of the log has set.
pub(super) enum Untold {
    Pose(KeyframeSeq, Pose),
    Point(SessionSeq, PointId, Point3),
}

/// A map's values, version by version.
pub(super) struct History {
    map: MapKey,
    /// Whether the map kept its history all the time.
    pub(super) is_whole: bool,
    /// As they stand at the version that was reached; poses of keyframes to come as they will be sent.
    standing: Values,
    /// Of points that were forgotten: as they were when they came again.
    again: HashMap<Point, VecDeque<[f64; 3]>>,
    /// As they stand in the end, where they wait for their rows.
    waiting: Values,
}

impl History {
    /// Goes back to a map's first version.
    pub(super) async fn rewind(db: &mut Connection, map: MapKey) -> Result<Self, StoreError> {
        let mut history = Self {
            map,
            is_whole: true,
            standing: Values::default(),
            again: HashMap::new(),
            waiting: Values::default(),
        };
        let waiting = &mut history.waiting;
        let take = |changes: Vec<Change>| changes.iter().for_each(|change| waiting.apply(change));
        deferred::for_each(db, map, take).await?;
        // Points whose value is known that they have until they are forgotten.
        let mut known = HashSet::new();
        let mut last = 0;
        while let Some((version, entries)) = log_rows::after(db, map, last).await? {
            last = version;
            for Entry { changes, former, .. } in entries {
                history.is_whole &= !changes.iter().any(|change| {
                    matches!(&**change, Change::MapSet(properties) if !properties.settings.keep_history)
                });
                history.learn(former.into_owned(), &mut known);
            }
        }
        let first = history.again.iter_mut();
        let first = first.filter_map(|(point, values)| Some((*point, values.pop_front()?)));
        history.standing.points = first.collect();
        Ok(history)
    }

    /// Takes what a version replaced.
    fn learn(&mut self, former: FormerValues, known: &mut HashSet<Point>) {
        for (keyframe, pose) in former.poses {
            self.standing.poses.entry(keyframe).or_insert(pose);
        }
        let mut stood = |point: Point, at: [f64; 3]| {
            if known.insert(point) {
                self.again.entry(point).or_default().push_back(at);
            }
        };
        for (session, id, at) in former.points {
            stood((session, id), at.map_or(ABSENT, |at| [at.x, at.y, at.z]));
        }
        for (session, id, at) in &former.forgotten {
            stood((*session, *id), [at.x, at.y, at.z]);
        }
        for (session, id, _) in former.forgotten {
            known.remove(&(session, id));
        }
    }

    /// Goes on to a version, which set and replaced these values.
    pub(super) fn advance(&mut self, entries: &[Entry<'_>]) {
        for entry in entries {
            for change in &entry.changes {
                self.standing.apply(change);
            }
            for (session, id, _) in &entry.former.forgotten {
                let point = (*session, *id);
                match self.again.get_mut(&point).and_then(VecDeque::pop_front) {
                    Some(at) => self.standing.points.insert(point, at),
                    None => self.standing.points.remove(&point),
                };
            }
        }
    }

    /// Returns a keyframe's pose, if it is not that of its row.
    pub(super) fn pose(&self, keyframe: KeyframeSeq) -> Option<Sim3> {
        self.standing.poses.get(&keyframe).or_else(|| self.waiting.poses.get(&keyframe)).copied()
    }

    /// Returns the positions of those points of a session that are there, in the order of `ids`.
    pub(super) async fn points(
        &self,
        db: &mut Connection,
        session: SessionSeq,
        ids: &[PointId],
    ) -> Result<Vec<(PointId, Point3)>, StoreError> {
        let elsewhere = |id: &PointId| {
            let point = (session, *id);
            self.standing.points.get(&point).or_else(|| self.waiting.points.get(&point))
        };
        let in_rows: Vec<PointId> = ids.iter().copied().filter(|id| elsewhere(id).is_none()).collect();
        let rows: HashMap<PointId, Point3> =
            point_blocks::positions(db, self.map, session, &in_rows).await?.into_iter().collect();
        let position = |id: &PointId| match elsewhere(id) {
            Some(at) => (!at[0].is_nan()).then(|| Point3::from(*at)),
            None => rows.get(id).copied(),
        };
        Ok(ids.iter().filter_map(|id| Some((*id, position(id)?))).collect())
    }

    /// Takes what stands in the end and the log does not tell of, because history was not kept then: poses, and points by session.
    pub(super) async fn untold(&mut self, db: &mut Connection) -> Result<Vec<Untold>, StoreError> {
        let Values { poses, points } = std::mem::take(&mut self.standing);
        let mut untold = Vec::new();
        let now = pose_rows(db, self.map, poses.keys().map(|keyframe| keyframe.0)).await?;
        let mut moved: Vec<_> = poses
            .into_iter()
            .filter_map(|(keyframe, told)| {
                let waiting = self.pose(keyframe).map(|pose| pose.without_scale());
                let now = waiting.or_else(|| now.get(&keyframe.0).copied())?;
                (now != told.without_scale()).then_some((keyframe, now))
            })
            .collect();
        moved.sort_unstable_by_key(|(keyframe, _)| *keyframe);
        untold.extend(moved.into_iter().map(|(keyframe, pose)| Untold::Pose(keyframe, pose)));
        let mut told: Vec<(Point, [f64; 3])> = points.into_iter().collect();
        told.sort_unstable_by_key(|(point, _)| *point);
        for of_session in told.chunk_by(|a, b| a.0.0 == b.0.0) {
            let session = of_session[0].0.0;
            let ids: Vec<PointId> = of_session.iter().map(|((_, id), _)| *id).collect();
            let told: HashMap<PointId, Point3> =
                of_session.iter().map(|((_, id), at)| (*id, Point3::from(*at))).collect();
            for (id, now) in self.points(db, session, &ids).await? {
                if told.get(&id) != Some(&now) {
                    untold.push(Untold::Point(session, id, now));
                }
            }
        }
        Ok(untold)
    }
}

async fn pose_rows(
    db: &mut Connection,
    map: MapKey,
    keyframes: impl Iterator<Item = u32>,
) -> Result<HashMap<u32, Pose>, StoreError> {
    let select = "select keyframe, pose from keyframes
        where map_key = $1 and keyframe in (select cast(value as bigint) from json_each($2))";
    let listed: Vec<u32> = keyframes.collect();
    let query = sql::query_as(select).bind(map).bind(serde_json::json!(listed).to_string());
    Ok(query.fetch_all(db).await?.into_iter().collect())
}
