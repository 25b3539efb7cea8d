//! Frames of a map's sessions, as a row.

use serde::{Deserialize, Serialize};

use super::decode;
use super::statement::run;
use crate::domain::fleet_frames::{FleetFrames, FramedSession, Suspect};
use crate::domain::ids::SessionSeq;
use crate::geometry::Pose;
use crate::store::StoreError;
use crate::store::commit::job::MapKey;
use crate::store::sql::{self, Connection};

/// The frames, as JSON. Sessions go by their numbers, which are given once.
#[derive(Serialize, Deserialize)]
struct FramesRow {
    sessions: Vec<SessionRow>,
    suspects: Vec<SuspectRow>,
    loops: usize,
    left_out: usize,
}

#[derive(Serialize, Deserialize)]
struct SessionRow {
    session: u32,
    root: u32,
    translation: [f64; 3],
    rotation: [f64; 4],
    residual_m: Option<f64>,
    loops: usize,
}

#[derive(Serialize, Deserialize)]
struct SuspectRow {
    id: String,
    cycle: Vec<String>,
    off_m: f64,
    off_rad: f64,
}

/// Keeps the frames of a map, in place of those of before.
pub(in crate::store) async fn keep(
    db: &mut Connection,
    map: MapKey,
    version: u64,
    frames: &FleetFrames,
) -> Result<(), StoreError> {
    let body = serde_json::to_string(&FramesRow::from(frames))
        .map_err(|error| StoreError::Database(error.to_string()))?;
    // A map that was deleted meanwhile has none.
    let insert = "insert into fleet_frames (map_key, version, body) select map_key, $2, $3 from maps where map_key = $1
        on conflict (map_key) do update set version = excluded.version, body = excluded.body";
    run(db, sql::query(insert).bind(map).bind(version as i64).bind(body)).await
}

/// Returns the frames of a map and the version that they were computed at, if any were.
pub(in crate::store) async fn kept(
    db: &mut Connection,
    map: MapKey,
) -> Result<Option<(u64, FleetFrames)>, StoreError> {
    let select = "select version, body from fleet_frames where map_key = $1";
    let found: Option<(i64, String)> = sql::query_as(select).bind(map).fetch_optional(db).await?;
    let Some((version, body)) = found else { return Ok(None) };
    let row: FramesRow = serde_json::from_str(&body)
        .map_err(|error| StoreError::corrupt(format!("the frames of version {version}: {error}")))?;
    Ok(Some((version as u64, row.frames()?)))
}

impl From<&FleetFrames> for FramesRow {
    fn from(frames: &FleetFrames) -> Self {
        let session = |of: &FramedSession| SessionRow {
            session: of.session.0,
            root: of.root.0,
            translation: of.root_from_session.translation_m(),
            rotation: of.root_from_session.rotation_xyzw(),
            residual_m: of.residual_m,
            loops: of.loops,
        };
        let suspect = |of: &Suspect| SuspectRow {
            id: of.loop_id.to_string(),
            cycle: of.cycle.iter().map(ToString::to_string).collect(),
            off_m: of.off_m,
            off_rad: of.off_rad,
        };
        Self {
            sessions: frames.sessions.iter().map(session).collect(),
            suspects: frames.suspects.iter().map(suspect).collect(),
            loops: frames.loops,
            left_out: frames.left_out,
        }
    }
}

impl FramesRow {
    fn frames(self) -> Result<FleetFrames, StoreError> {
        let session = |row: SessionRow| FramedSession {
            session: SessionSeq(row.session),
            root: SessionSeq(row.root),
            root_from_session: Pose::from_stored(row.translation, row.rotation),
            residual_m: row.residual_m,
            loops: row.loops,
        };
        let suspect = |row: SuspectRow| {
            Ok(Suspect {
                loop_id: decode::id(&row.id)?,
                cycle: row.cycle.iter().map(|id| decode::id(id)).collect::<Result<_, StoreError>>()?,
                off_m: row.off_m,
                off_rad: row.off_rad,
            })
        };
        Ok(FleetFrames {
            sessions: self.sessions.into_iter().map(session).collect(),
            suspects: self.suspects.into_iter().map(suspect).collect::<Result<_, StoreError>>()?,
            loops: self.loops,
            left_out: self.left_out,
        })
    }
}
