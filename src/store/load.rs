//! From rows to changes: how a map's index is built when the map is first asked for.
//!
//! `MapIndex::build(load(map)) == live index` is the law of the house; the changes come in an order
//! in which every one finds what it names.

use std::collections::HashSet;
use std::sync::Arc;

use sqlx::Row;
use sqlx::sqlite::SqliteRow;

use super::blob::{unpack, unpack_array};
use super::job::MapKey;
use super::{Store, StoreError, map_rows, model_rows};
use crate::geometry::{Point3, Pose};
use crate::model::anchor::Observation;
use crate::model::bow::BowVector;
use crate::model::change::{Change, Keyframe, Loop, Merge, MergeCause};
use crate::model::ids::{AnchorSeq, KeyframeSeq, LoopId, MapId, PointId, SessionSeq};
use crate::model::key::KeySeq;
use crate::model::keyframe::{Camera, Stamp};
use crate::model::request::Digest;
use crate::recognition::index::MapIndex;

/// Rows read at a time: a map may be larger than its index.
const CHUNK: i64 = 2_000;

/// A map as the store knows it.
#[derive(Debug)]
pub struct Loaded {
    /// Its key.
    pub key: MapKey,
    /// Its version.
    pub version: u64,
    /// The number of its next event.
    pub next_event: u64,
    /// The number of the next loop query to be kept.
    pub next_kept: i64,
    /// The digest of the body that made it.
    pub digest: Digest,
    /// The key that made it.
    pub owner: Option<KeySeq>,
    /// Everything derived from its facts.
    pub index: MapIndex,
}

/// In which order facts are told to an index. It must not matter: `revisit check` holds the two against each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Order {
    /// As they came.
    Forwards,
    /// The last first, and what moves things after the things.
    Backwards,
}

impl Store {
    /// Loads a map and builds its index; `None` if there is no such map.
    pub async fn load(&self, id: &MapId) -> Result<Option<Loaded>, StoreError> {
        // One read transaction, so that what is built is one version of the map.
        let mut db = self.snapshot().await?;
        let loaded = load(&mut db, id, Order::Forwards).await?;
        db.commit().await?;
        Ok(loaded)
    }

    /// The same index, built from the facts told backwards.
    #[cfg(test)]
    pub async fn load_backwards(&self, id: &MapId) -> Result<Option<Loaded>, StoreError> {
        let mut db = self.snapshot().await?;
        let loaded = load(&mut db, id, Order::Backwards).await?;
        db.commit().await?;
        Ok(loaded)
    }
}

/// Loads a map within a read transaction.
pub(super) async fn load(db: &mut Db, id: &MapId, order: Order) -> Result<Option<Loaded>, StoreError> {
    let found =
        sqlx::query("select * from maps where id = $1").bind(id.as_str()).fetch_optional(&mut *db).await?;
    let Some(row) = found else { return Ok(None) };
    let key: MapKey = row.try_get("map_key")?;
    let mut index = MapIndex::default();
    index.apply(&[Change::MapSet(Box::new(map_rows::properties(db, key, &row).await?))]);
    if let Some(vocabulary) = row.try_get::<Option<String>, _>("vocabulary")? {
        index.apply(&[Change::VocabularySet(vocabulary.into())]);
    }
    let sessions = sessions(db, key).await?;
    let next = (row.try_get("next_keyframe")?, row.try_get("next_anchor")?);
    match order {
        Order::Forwards => {
            index.apply(&sessions);
            load_points(db, key, &mut index).await?;
            load_keyframes(db, key, &mut index).await?;
            index.reserve(next.0, next.1);
            index.apply(&model_rows::verdicts(db, key).await?);
            let (anchors, observed) = anchors(db, key).await?;
            index.apply(&[anchors, observed].concat());
            let (loops, merges) = loops_and_merges(db, key).await?;
            index.apply(&[loops, merges].concat());
        }
        Order::Backwards => {
            index.reserve(next.0, next.1);
            index.apply(&reversed(sessions));
            load_keyframes_backwards(db, key, &mut index).await?;
            let (anchors, observed) = anchors(db, key).await?;
            index.apply(&anchors);
            let (loops, merges) = loops_and_merges(db, key).await?;
            index.apply(&reversed(merges));
            index.apply(&reversed(loops));
            for change in reversed(observed) {
                index.apply(&[change]);
            }
            load_points(db, key, &mut index).await?;
            index.apply(&reversed(model_rows::verdicts(db, key).await?));
        }
    }
    let next_kept =
        sqlx::query_scalar("select coalesce(max(kept), 0) + 1 from loop_queries where map_key = $1");
    Ok(Some(Loaded {
        key,
        version: row.try_get::<i64, _>("version")? as u64,
        next_event: row.try_get::<i64, _>("next_event")? as u64,
        next_kept: next_kept.bind(key).fetch_one(&mut *db).await?,
        digest: digest(&row)?,
        owner: row.try_get::<Option<i64>, _>("owner")?.map(KeySeq),
        index,
    }))
}

fn reversed(mut changes: Vec<Change>) -> Vec<Change> {
    changes.reverse();
    changes
}

type Db = sqlx::SqliteConnection;

pub(super) fn digest(row: &SqliteRow) -> Result<Digest, StoreError> {
    let bytes: &[u8] = row.try_get("digest")?;
    bytes.try_into().map_err(|_| StoreError::corrupt("a digest of another length"))
}

async fn sessions(db: &mut Db, key: MapKey) -> Result<Vec<Change>, StoreError> {
    let select = "select session, id from sessions where map_key = $1 order by session";
    let rows: Vec<(u32, String)> = sqlx::query_as(select).bind(key).fetch_all(db).await?;
    rows.into_iter().map(|(seq, id)| Ok(Change::SessionAdded(SessionSeq(seq), parse(&id)?))).collect()
}

async fn load_points(db: &mut Db, key: MapKey, index: &mut MapIndex) -> Result<(), StoreError> {
    let select = "select session, point, x, y, z from map_points
        where map_key = $1 and (session, point) > ($2, $3) order by session, point limit $4";
    let (mut session, mut point) = (-1_i64, i64::MIN);
    loop {
        let rows: Vec<(u32, i64, f64, f64, f64)> = sqlx::query_as(select)
            .bind(key)
            .bind(session)
            .bind(point)
            .bind(CHUNK)
            .fetch_all(&mut *db)
            .await?;
        let Some(last) = rows.last() else { return Ok(()) };
        (session, point) = (i64::from(last.0), last.1);
        let set = |(s, id, x, y, z)| Change::PointSet(SessionSeq(s), id, Point3::new(x, y, z));
        index.apply(&rows.into_iter().map(set).collect::<Vec<_>>());
    }
}

async fn load_keyframes(db: &mut Db, key: MapKey, index: &mut MapIndex) -> Result<(), StoreError> {
    let select = "select * from keyframes where map_key = $1 and keyframe > $2 order by keyframe limit $3";
    let mut last = -1_i64;
    loop {
        let rows = sqlx::query(select).bind(key).bind(last).bind(CHUNK).fetch_all(&mut *db).await?;
        let Some(row) = rows.last() else { return Ok(()) };
        last = row.try_get("keyframe")?;
        for row in &rows {
            let (mut keyframe, bow) = keyframe(row)?;
            // What was declared about keyframes that were culled since is no fact any more.
            keyframe.declared = keyframe
                .declared
                .iter()
                .copied()
                .filter(|(other, _)| index.keyframe(*other).is_some())
                .collect();
            index.apply(&[Change::KeyframeAdded(Box::new(keyframe), Arc::new(bow))]);
        }
    }
}

async fn load_keyframes_backwards(db: &mut Db, key: MapKey, index: &mut MapIndex) -> Result<(), StoreError> {
    let select = "select keyframe from keyframes where map_key = $1";
    let standing: Vec<u32> = sqlx::query_scalar(select).bind(key).fetch_all(&mut *db).await?;
    let standing: HashSet<KeyframeSeq> = standing.into_iter().map(KeyframeSeq).collect();
    let select =
        "select * from keyframes where map_key = $1 and keyframe < $2 order by keyframe desc limit $3";
    let mut last = i64::MAX;
    loop {
        let rows = sqlx::query(select).bind(key).bind(last).bind(CHUNK).fetch_all(&mut *db).await?;
        let Some(row) = rows.last() else { return Ok(()) };
        last = row.try_get("keyframe")?;
        for row in &rows {
            let (mut keyframe, bow) = keyframe(row)?;
            keyframe.declared =
                keyframe.declared.iter().copied().filter(|(other, _)| standing.contains(other)).collect();
            index.apply(&[Change::KeyframeAdded(Box::new(keyframe), Arc::new(bow))]);
        }
    }
}

pub(super) fn keyframe(row: &SqliteRow) -> Result<(Keyframe, BowVector), StoreError> {
    let declared: Vec<(u32, u32)> = unpack(row.try_get("declared")?)?;
    let keyframe = Keyframe {
        seq: KeyframeSeq(row.try_get("keyframe")?),
        id: parse(row.try_get("id")?)?,
        session: SessionSeq(row.try_get("session")?),
        stamp: Stamp { sec: row.try_get("stamp_sec")?, nanosec: row.try_get("stamp_nanosec")? },
        map_from_camera: pose(row.try_get("pose")?)?,
        camera: row.try_get::<Option<&[u8]>, _>("camera")?.map(camera).transpose()?,
        observes: unpack::<PointId>(row.try_get("observes")?)?.into(),
        declared: declared.into_iter().map(|(other, shared)| (KeyframeSeq(other), shared)).collect(),
        bytes: row.try_get::<i64, _>("bytes")? as u64,
    };
    Ok((keyframe, bow(row)?))
}

pub(super) fn bow(row: &SqliteRow) -> Result<BowVector, StoreError> {
    let (words, weights) = (unpack(row.try_get("bow_words")?)?, unpack(row.try_get("bow_weights")?)?);
    BowVector::from_parts(words, weights).map_err(|error| StoreError::corrupt(error.to_string()))
}

fn pose(bytes: &[u8]) -> Result<Pose, StoreError> {
    let [x, y, z, qx, qy, qz, qw] = unpack_array(bytes)?;
    Ok(Pose::from_stored([x, y, z], [qx, qy, qz, qw]))
}

fn camera(bytes: &[u8]) -> Result<Camera, StoreError> {
    const FLOATS: usize = 4 * size_of::<f64>();
    let (floats, integers) =
        bytes.split_at_checked(FLOATS).ok_or_else(|| StoreError::corrupt("a camera is short"))?;
    let [fx, fy, cx, cy] = unpack_array(floats)?;
    let [width, height] = unpack_array(integers)?;
    Ok(Camera { fx, fy, cx, cy, width, height })
}

pub(super) fn point(bytes: &[u8]) -> Result<Point3, StoreError> {
    Ok(Point3::from(unpack_array::<f64, 3>(bytes)?))
}

/// The anchors, and what was observed of them.
async fn anchors(db: &mut Db, key: MapKey) -> Result<(Vec<Change>, Vec<Change>), StoreError> {
    let (mut changes, mut observed) = (Vec::new(), Vec::new());
    let select =
        "select anchor, class, description_by_hand, version from anchors where map_key = $1 order by anchor";
    let rows: Vec<(u32, String, Option<String>, i64)> =
        sqlx::query_as(select).bind(key).fetch_all(&mut *db).await?;
    for (seq, class, by_hand, version) in rows {
        let seq = AnchorSeq(seq);
        changes.push(Change::AnchorAdded(seq, class.into()));
        changes.push(Change::AnchorTouched(seq, version as u64));
        if by_hand.is_some() {
            changes.push(Change::DescriptionSet(seq, by_hand.map(Into::into)));
        }
    }
    let select = "select keyframe, detection from crops where map_key = $1";
    let crops: Vec<(u32, u16)> = sqlx::query_as(select).bind(key).fetch_all(&mut *db).await?;
    let crops: HashSet<(u32, u16)> = crops.into_iter().collect();
    let mut readings = model_rows::readings(&mut *db, key).await?;
    let select =
        "select * from detections where map_key = $1 and anchor is not null order by keyframe, detection";
    for row in sqlx::query(select).bind(key).fetch_all(&mut *db).await? {
        let at = (row.try_get("keyframe")?, row.try_get("detection")?);
        let mut observation = observation(&row, crops.contains(&at))?;
        observation.crop_reading = readings.remove(&at);
        observed.push(Change::Observed(AnchorSeq(row.try_get("anchor")?), Box::new(observation)));
    }
    Ok((changes, observed))
}

fn observation(row: &SqliteRow, has_crop: bool) -> Result<Observation, StoreError> {
    let [x0, y0, x1, y1]: [f64; 4] = unpack_array(row.try_get("box_px")?)?;
    let (text, description): (Option<&str>, Option<&str>) =
        (row.try_get("text")?, row.try_get("description")?);
    let map_points: Vec<i64> = unpack(row.try_get("map_points")?)?;
    Ok(Observation {
        keyframe: KeyframeSeq(row.try_get("keyframe")?),
        detection: row.try_get("detection")?,
        confidence: row.try_get("confidence")?,
        map_points: map_points.into(),
        position_in_session: row.try_get::<Option<&[u8]>, _>("position")?.map(point).transpose()?,
        reading: description.or(text).map(Into::into),
        described: description.is_some(),
        crop_area_px: has_crop.then_some((x1 - x0) * (y1 - y0)),
        crop_reading: None,
    })
}

async fn loops_and_merges(db: &mut Db, key: MapKey) -> Result<(Vec<Change>, Vec<Change>), StoreError> {
    let (mut loops, mut merges) = (Vec::new(), Vec::new());
    for row in sqlx::query("select * from loops where map_key = $1 order by id")
        .bind(key)
        .fetch_all(&mut *db)
        .await?
    {
        loops.push(Change::LoopAdded(Loop {
            id: parse::<LoopId>(row.try_get("id")?)?,
            keyframe: KeyframeSeq(row.try_get("keyframe")?),
            candidate: KeyframeSeq(row.try_get("candidate")?),
            keyframe_id: parse(row.try_get("keyframe_id")?)?,
            candidate_id: parse(row.try_get("candidate_id")?)?,
            query: row.try_get("query")?,
        }));
    }
    let select = "select into_anchor, from_anchor, loop_id from anchor_merges where map_key = $1";
    let rows: Vec<(u32, u32, String)> = sqlx::query_as(select).bind(key).fetch_all(&mut *db).await?;
    for (into, from, by) in rows {
        let cause = if by.is_empty() { MergeCause::Covisible } else { MergeCause::Loop(parse(&by)?) };
        merges.push(Change::Merged(Merge { into: AnchorSeq(into), from: AnchorSeq(from), cause }));
    }
    Ok((loops, merges))
}

pub(super) fn parse<T: std::str::FromStr>(text: &str) -> Result<T, StoreError>
where
    T::Err: std::fmt::Display,
{
    text.parse().map_err(|error| StoreError::corrupt(format!("{text:?}: {error}")))
}
