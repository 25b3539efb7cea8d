//! History: a map's poses and positions as they were at any version, walked from the first to the last.
//!
//! Rows hold what stands now, and `former_values` what was replaced. Going back from now, the value that a version set is
//! known when its turn comes; it is written into a temporary file, and what it replaced stands from there on. At the end
//! of the way back stand the first values, and the file is read in the other direction. So memory holds each replaced
//! value once, however often it was replaced.

use std::collections::HashMap;
use std::io::{Read as _, Seek as _, SeekFrom, Write as _};
use std::path::Path;

use tempfile::SpooledTempFile;

use crate::domain::change::Change;
use crate::domain::former::FormerValues;
use crate::domain::ids::{KeyframeSeq, PointId, SessionSeq};
use crate::geometry::{Point3, Pose};
use crate::store::StoreError;
use crate::store::commit::job::MapKey;
use crate::store::rows::point_blocks;
use crate::store::rows::{decode, former_value_rows};
use crate::store::slices::deferred;
use crate::store::slices::parts::Kind;
use crate::store::sql::{self, Connection};

/// The temporary file is kept in memory up to this size.
const SPOOLED_BYTES: usize = 4 << 20;

/// The values that a version set: lists as those of the values that it replaced.
pub(super) type NewValues = FormerValues;

/// The values of a map that are not those of its rows, as they stand at a version.
#[derive(Default)]
struct CandidateStage {
    poses: HashMap<KeyframeSeq, Pose>,
    /// By session. A large map that was corrected as a whole has all its points here, so each takes few bytes.
    points: HashMap<SessionSeq, HashMap<PointId, [f64; 3]>>,
    positions: HashMap<(KeyframeSeq, u16), Point3>,
}

/// The coordinates of a point that is not there.
const ABSENT: [f64; 3] = [f64::NAN; 3];

impl CandidateStage {
    fn set(&mut self, values: &FormerValues) {
        self.poses.extend(values.poses.iter().copied());
        for (session, id, at) in &values.points {
            self.set_point(*session, *id, *at);
        }
        self.positions.extend(values.positions.iter().map(|(keyframe, n, at)| ((*keyframe, *n), *at)));
    }

    fn set_point(&mut self, session: SessionSeq, id: PointId, at: Option<Point3>) {
        self.points.entry(session).or_default().insert(id, at.map_or(ABSENT, |at| [at.x, at.y, at.z]));
    }

    /// Returns a point's position if it is not that of its row; [`ABSENT`] if the point is not there.
    fn point(&self, session: SessionSeq, id: PointId) -> Option<[f64; 3]> {
        self.points.get(&session)?.get(&id).copied()
    }

    /// Brings points back that were forgotten, or takes them away: then their coordinates are those of [`ABSENT`], or of the
    /// keyframe that will bring them again.
    fn set_forgotten(&mut self, forgotten: &[(SessionSeq, PointId, Point3)]) {
        for (session, id, at) in forgotten {
            self.set_point(*session, *id, Some(*at));
        }
    }
}

/// A part of the file: values that a version set.
struct Written {
    version: u64,
    kind: Kind,
    offset: u64,
    bytes: usize,
}

/// A map's values, version by version.
pub(super) struct History {
    map: MapKey,
    standing: CandidateStage,
    file: SpooledTempFile,
    /// The last is the next.
    written: Vec<Written>,
}

impl History {
    /// Goes back to a map's first version.
    pub(super) async fn rewind(db: &mut Connection, map: MapKey) -> Result<Self, StoreError> {
        let mut history = Self {
            map,
            standing: CandidateStage::default(),
            file: SpooledTempFile::new(SPOOLED_BYTES),
            written: Vec::new(),
        };
        deferred::for_each(db, map, |change| history.apply_deferred(change)).await?;
        let select = "select version, part, kind, 0 from former_values where map_key = $1
            union all select p.version, p.part, p.kind, 1 from deferred_parts p
                join deferred_changes c on c.map_key = p.map_key and c.version = p.version and p.part >= c.part
                where p.map_key = $1 and p.kind like 'former_%'
            order by 1 desc, 2 desc";
        let parts: Vec<(i64, u32, String, bool)> =
            sql::query_as(select).bind(map).fetch_all(&mut *db).await?;
        for (version, part, kind, is_staged) in parts {
            let kind = Kind::from_name(&kind)?;
            let select = if is_staged {
                "select entries from deferred_parts where map_key = $1 and version = $2 and part = $3"
            } else {
                "select entries from former_values where map_key = $1 and version = $2 and part = $3"
            };
            let entries = sql::query_scalar(select).bind(map).bind(version).bind(part);
            let entries: Vec<u8> = entries.fetch_one(&mut *db).await?;
            let former = former_value_rows::unpacked(kind, &entries)?;
            let new = history.values_for(db, &former).await?;
            history.write(version as u64, &new)?;
            history.standing.set(&former);
            history.standing.set_forgotten(&former.forgotten);
        }
        Ok(history)
    }

    /// Takes a change that is committed and not in its row yet.
    fn apply_deferred(&mut self, change: Change) {
        let standing = &mut self.standing;
        match change {
            Change::PoseSet(keyframe, pose) => drop(standing.poses.insert(keyframe, pose)),
            Change::PointSet(session, id, at) => standing.set_point(session, id, Some(at)),
            Change::PointsForgotten(session, ids) => {
                ids.iter().for_each(|id| standing.set_point(session, *id, None));
            }
            Change::PositionSet(_, keyframe, detection, at) => {
                standing.positions.insert((keyframe, detection), at);
            }
            _ => {}
        }
    }

    /// Returns the version of the next change of values.
    pub(super) fn next_version(&self) -> Option<u64> {
        self.written.last().map(|written| written.version)
    }

    /// Goes on to the next version, and returns the values that it set.
    pub(super) fn advance(&mut self) -> Result<NewValues, StoreError> {
        let mut new = NewValues::default();
        let Some(version) = self.next_version() else { return Ok(new) };
        while let Some(written) = self.written.pop_if(|written| written.version == version) {
            let mut entries = vec![0; written.bytes];
            self.file.seek(SeekFrom::Start(written.offset)).map_err(temporary)?;
            self.file.read_exact(&mut entries).map_err(temporary)?;
            let values = former_value_rows::unpacked(written.kind, &entries)?;
            self.standing.set(&values);
            self.standing.set_forgotten(&values.forgotten);
            new.poses.extend(values.poses);
            new.points.extend(values.points);
            new.positions.extend(values.positions);
        }
        Ok(new)
    }

    /// Returns a keyframe's pose, if it is not that of its row.
    pub(super) fn pose(&self, keyframe: KeyframeSeq) -> Option<Pose> {
        self.standing.poses.get(&keyframe).copied()
    }

    /// Returns a detection's position, if it is not that of its row.
    pub(super) fn position(&self, keyframe: KeyframeSeq, detection: u16) -> Option<Point3> {
        self.standing.positions.get(&(keyframe, detection)).copied()
    }

    /// Returns the positions of those points of a session that are there, in the order of `ids`.
    pub(super) async fn points(
        &self,
        db: &mut Connection,
        session: SessionSeq,
        ids: &[PointId],
    ) -> Result<Vec<(PointId, Point3)>, StoreError> {
        let elsewhere: Vec<PointId> =
            ids.iter().copied().filter(|id| self.standing.point(session, *id).is_none()).collect();
        let rows = point_rows(db, self.map, session, &elsewhere).await?;
        let position = |id: &PointId| match self.standing.point(session, *id) {
            Some(at) => (!at[0].is_nan()).then(|| Point3::from(at)),
            None => rows.get(id).copied(),
        };
        Ok(ids.iter().filter_map(|id| Some((*id, position(id)?))).collect())
    }

    /// Returns the values that now stand in the place of former ones. What is gone since has none.
    async fn values_for(&self, db: &mut Connection, former: &FormerValues) -> Result<NewValues, StoreError> {
        let keyframes = former.poses.iter().map(|(keyframe, _)| *keyframe);
        let elsewhere: Vec<u32> =
            keyframes.filter(|keyframe| self.pose(*keyframe).is_none()).map(|keyframe| keyframe.0).collect();
        let rows = pose_rows(db, self.map, &elsewhere).await?;
        let pose = |keyframe: KeyframeSeq| self.pose(keyframe).or_else(|| rows.get(&keyframe.0).copied());
        let poses = former.poses.iter().filter_map(|(keyframe, _)| Some((*keyframe, pose(*keyframe)?)));
        let mut new = NewValues { poses: poses.collect(), ..NewValues::default() };
        for of_session in former.forgotten.chunk_by(|a, b| a.0 == b.0) {
            let session = of_session[0].0;
            let ids: Vec<PointId> = of_session.iter().map(|(_, id, _)| *id).collect();
            let found: HashMap<PointId, Point3> = self.points(db, session, &ids).await?.into_iter().collect();
            let at = |id: &PointId| found.get(id).copied().unwrap_or_else(|| Point3::from(ABSENT));
            new.forgotten.extend(ids.iter().map(|id| (session, *id, at(id))));
        }
        for of_session in former.points.chunk_by(|a, b| a.0 == b.0) {
            let session = of_session[0].0;
            let ids: Vec<PointId> = of_session.iter().map(|(_, id, _)| *id).collect();
            let found: HashMap<PointId, Point3> = self.points(db, session, &ids).await?.into_iter().collect();
            new.points.extend(ids.into_iter().map(|id| (session, id, found.get(&id).copied())));
        }
        let elsewhere: Vec<u32> = former
            .positions
            .iter()
            .filter(|(keyframe, detection, _)| self.position(*keyframe, *detection).is_none())
            .map(|(keyframe, ..)| keyframe.0)
            .collect();
        let rows = position_rows(db, self.map, &elsewhere).await?;
        new.positions = former
            .positions
            .iter()
            .filter_map(|(keyframe, detection, _)| {
                let stands = self.position(*keyframe, *detection);
                Some((
                    *keyframe,
                    *detection,
                    stands.or_else(|| rows.get(&(keyframe.0, *detection)).copied())?,
                ))
            })
            .collect();
        Ok(new)
    }

    fn write(&mut self, version: u64, new: &NewValues) -> Result<(), StoreError> {
        for part in former_value_rows::packed(new) {
            let offset = self.file.seek(SeekFrom::End(0)).map_err(temporary)?;
            self.file.write_all(&part.entries).map_err(temporary)?;
            self.written.push(Written { version, kind: part.kind, offset, bytes: part.entries.len() });
        }
        Ok(())
    }
}

#[expect(clippy::needless_pass_by_value, reason = "an adapter for map_err")]
fn temporary(error: std::io::Error) -> StoreError {
    StoreError::file(Path::new("a temporary file"), &error)
}

/// A JSON list of numbers: one parameter, however many they are.
fn list(numbers: impl IntoIterator<Item = impl Into<i64>>) -> String {
    let numbers: Vec<i64> = numbers.into_iter().map(Into::into).collect();
    serde_json::json!(numbers).to_string()
}

async fn point_rows(
    db: &mut Connection,
    map: MapKey,
    session: SessionSeq,
    ids: &[PointId],
) -> Result<HashMap<PointId, Point3>, StoreError> {
    Ok(point_blocks::positions(db, map, session, ids).await?.into_iter().collect())
}

async fn pose_rows(
    db: &mut Connection,
    map: MapKey,
    keyframes: &[u32],
) -> Result<HashMap<u32, Pose>, StoreError> {
    if keyframes.is_empty() {
        return Ok(HashMap::new());
    }
    let select = "select keyframe, pose from keyframes
        where map_key = $1 and keyframe in (select cast(value as bigint) from json_each($2))";
    let query = sql::query_as(select).bind(map).bind(list(keyframes.iter().copied()));
    let rows: Vec<(u32, Vec<u8>)> = query.fetch_all(db).await?;
    rows.into_iter().map(|(keyframe, pose)| Ok((keyframe, decode::pose(&pose)?))).collect()
}

async fn position_rows(
    db: &mut Connection,
    map: MapKey,
    keyframes: &[u32],
) -> Result<HashMap<(u32, u16), Point3>, StoreError> {
    if keyframes.is_empty() {
        return Ok(HashMap::new());
    }
    let select = "select keyframe, detection, position from detections
        where map_key = $1 and keyframe in (select cast(value as bigint) from json_each($2)) and position is not null";
    let query = sql::query_as(select).bind(map).bind(list(keyframes.iter().copied()));
    let rows: Vec<(u32, u16, Vec<u8>)> = query.fetch_all(db).await?;
    rows.into_iter().map(|(keyframe, n, at)| Ok(((keyframe, n), decode::point(&at)?))).collect()
}
