//! Reads of one row, by the pool of readers.

use std::ops::Range;

use revisit_core::domain::anchor::{IgnoredReason, Outcome};
use revisit_core::domain::bow::BowVector;
use revisit_core::domain::event::Event;
use revisit_core::domain::fleet_frames::FleetFrames;
use revisit_core::domain::former::FormerValues;
use revisit_core::domain::ids::{KeyframeSeq, MapId, PointId, SessionSeq};
use revisit_core::domain::keyframe::{Crop, Detection, Features};
use revisit_core::domain::request::Digest;
use revisit_core::domain::session_merge::MergeUndo;

use crate::columns::blob::unpack;
use crate::columns::clock::stamp_of_micros;
use crate::columns::column::integers_of;
use crate::columns::keypoints::keypoints_of;
use crate::map_key::MapKey;
use crate::rows::decode;
use crate::rows::frame_rows;
use crate::rows::session_merge_rows;
use crate::sql::{self, Row};
use crate::{Store, StoreError};

/// What only the store keeps of a keyframe.
#[derive(Clone, Debug)]
pub struct KeyframeRow {
    /// Its bag of words.
    pub bow: BowVector,
    /// Its features.
    pub features: Option<Features>,
    /// The points it was sent with a position for.
    pub sent_points: Vec<PointId>,
    /// Its detections, in their order.
    pub detections: Vec<DetectionRow>,
    /// The digest that tells a retry of it from another keyframe.
    pub digest: Digest,
}

/// A detection and what became of it.
#[derive(Clone, Debug)]
pub struct DetectionRow {
    /// Whether its crop is kept.
    pub has_crop: bool,
    /// As sent, without the crop.
    pub detection: Detection,
    /// What became of it.
    pub outcome: Outcome,
}

impl Store {
    /// Returns the names of the maps after one, ascending, without their releases.
    pub async fn map_ids(&self, after: Option<&MapId>, limit: usize) -> Result<Vec<MapId>, StoreError> {
        let select =
            "select id from maps where id > $1 and deleted = 0 and id not like '%/%' order by id limit $2";
        let after = after.map_or("", MapId::as_str);
        Ok(sql::query_scalar(select).bind(after).bind(limit).fetch_all(&self.readers).await?)
    }

    /// Returns the bag of words of a keyframe.
    pub async fn bow(&self, map: MapKey, keyframe: KeyframeSeq) -> Result<Option<BowVector>, StoreError> {
        let select = "select bow_words, bow_weights from keyframes where map_key = $1 and keyframe = $2";
        let row = sql::query(select).bind(map).bind(keyframe).fetch_optional(&self.readers).await?;
        let of_row = |error: StoreError| error.of_row(format!("keyframe number {}", keyframe.0));
        self.of_map(map, row.as_ref().map(decode::bow).transpose().map_err(of_row)).await
    }

    /// Returns the features of a keyframe, if it has any.
    pub async fn features(&self, map: MapKey, keyframe: KeyframeSeq) -> Result<Option<Features>, StoreError> {
        let select = "select * from keyframe_features where map_key = $1 and keyframe = $2";
        let row = sql::query(select).bind(map).bind(keyframe).fetch_optional(&self.readers).await?;
        let of_row =
            |error: StoreError| error.of_row(format!("the features of keyframe number {}", keyframe.0));
        self.of_map(map, row.as_ref().map(features).transpose().map_err(of_row)).await
    }

    /// Everything the store keeps of a keyframe but its crops.
    pub async fn keyframe(
        &self,
        map: MapKey,
        keyframe: KeyframeSeq,
    ) -> Result<Option<KeyframeRow>, StoreError> {
        let mut db = self.snapshot().await?;
        let select = "select bow_words, bow_weights, sent_points, digest from keyframes where map_key = $1 and keyframe = $2";
        let found = sql::query(select).bind(map).bind(keyframe).fetch_optional(&mut *db).await?;
        let Some(row) = found else {
            db.commit().await?;
            return Ok(None);
        };
        let select = "select * from keyframe_features where map_key = $1 and keyframe = $2";
        let features_row = sql::query(select).bind(map).bind(keyframe).fetch_optional(&mut *db).await?;
        let select = "select d.*, exists (select 1 from crops c where c.map_key = d.map_key and c.keyframe = d.keyframe
                and c.detection = d.detection) as has_crop
            from detections d where d.map_key = $1 and d.keyframe = $2 order by d.detection";
        let detections = sql::query(select).bind(map).bind(keyframe).fetch_all(&mut *db).await?;
        db.commit().await?;
        let of_row = |error: StoreError| error.of_row(format!("keyframe number {}", keyframe.0));
        let row = keyframe_row(&row, features_row.as_ref(), &detections).map_err(of_row);
        self.of_map(map, row.map(Some)).await
    }

    /// Returns the crop of a detection.
    pub async fn crop(
        &self,
        map: MapKey,
        keyframe: KeyframeSeq,
        detection: u16,
    ) -> Result<Option<Crop>, StoreError> {
        let select =
            "select media_type, bytes from crops where map_key = $1 and keyframe = $2 and detection = $3";
        let query = sql::query_as(select).bind(map).bind(keyframe).bind(detection);
        let found: Option<(String, Vec<u8>)> = query.fetch_optional(&self.readers).await?;
        let Some((media_type, bytes)) = found else { return Ok(None) };
        let crop = match Crop::media_type_of(&bytes) {
            Some(of_bytes) if of_bytes == media_type => Ok(Some(Crop { media_type: of_bytes, bytes })),
            _ => Err(StoreError::corrupt(format!(
                "the crop of detection {detection} of keyframe number {} is no such image",
                keyframe.0
            ))),
        };
        self.of_map(map, crop).await
    }

    /// Returns the kept answer of a loop query.
    pub async fn kept_query(&self, map: MapKey, id: &str) -> Result<Option<Vec<u8>>, StoreError> {
        let select = "select body from loop_queries where id = $2 and body is not null
            and map_key in (select $1 union all select release_key from releases where map_key = $1) limit 1";
        let found: Option<Vec<u8>> =
            sql::query_scalar(select).bind(map).bind(id).fetch_optional(&self.readers).await?;
        let whole = match found {
            Some(body) if !names_itself(id, &body) => {
                Err(StoreError::corrupt(format!("the answer of loop query {id} is damaged")))
            }
            found => Ok(found),
        };
        self.of_map(map, whole).await
    }

    /// Returns the frames of a map's sessions and the version that they were computed at, if any were.
    pub async fn frames(&self, map: MapKey) -> Result<Option<(u64, FleetFrames)>, StoreError> {
        let mut db = self.snapshot().await?;
        let found = frame_rows::kept(&mut db, map).await;
        db.commit().await?;
        self.of_map(map, found).await
    }

    /// Returns what revokes the merge of a session, with the values that it replaced; `None` if none can be revoked.
    pub async fn merge_undo(
        &self,
        map: MapKey,
        session: SessionSeq,
    ) -> Result<Option<(MergeUndo, FormerValues)>, StoreError> {
        let mut db = self.snapshot().await?;
        let found = session_merge_rows::undo(&mut db, map, session).await;
        db.commit().await?;
        self.of_map(map, found).await
    }

    /// Returns the numbers of the events that are kept of a map, up to the one given next; `None` if there is no such map.
    pub async fn kept_events(&self, map: MapKey) -> Result<Option<Range<u64>>, StoreError> {
        let select =
            "select coalesce((select min(seq) from events where map_key = $1), next_event), next_event
            from maps where map_key = $1 and deleted = 0";
        let kept = sql::query_as(select).bind(map).fetch_optional(&self.readers).await?;
        Ok(kept.map(|(oldest, next)| oldest..next))
    }

    /// Returns the events of a map after one, in their order.
    pub async fn events(&self, map: MapKey, since: u64, limit: usize) -> Result<Vec<Event>, StoreError> {
        let select = "select * from events where map_key = $1 and seq > $2 order by seq limit $3";
        let rows = sql::query(select).bind(map).bind(since).bind(limit).fetch_all(&self.readers).await?;
        let found = rows.iter().map(event).collect::<Result<Vec<Event>, _>>();
        let found = self.of_map(map, found).await?;
        let first = since.saturating_add(1);
        let mut expected = first;
        for event in &found {
            if event.seq != expected && (expected != first || self.has_events_up_to(map, since).await?) {
                let gap = format!("event {} follows upon {}", event.seq, expected - 1);
                return self.of_map(map, Err(StoreError::corrupt(gap))).await;
            }
            expected = event.seq + 1;
        }
        Ok(found)
    }

    /// Whether an event of this number or an earlier one is kept. The oldest are taken out, and none in the middle.
    async fn has_events_up_to(&self, map: MapKey, seq: u64) -> Result<bool, StoreError> {
        let select = "select exists (select 1 from events where map_key = $1 and seq <= $2)";
        Ok(sql::query_scalar(select).bind(map).bind(seq).fetch_one(&self.readers).await?)
    }

    /// Names the map in an error about one of its rows.
    pub(crate) async fn of_map<T>(&self, map: MapKey, read: Result<T, StoreError>) -> Result<T, StoreError> {
        let Err(error @ StoreError::Corrupt(_)) = read else { return read };
        let select = "select id from maps where map_key = $1";
        let id: Option<String> = sql::query_scalar(select).bind(map).fetch_optional(&self.readers).await?;
        Err(error.of_map(id.unwrap_or_else(|| format!("number {map}"))))
    }
}

/// Puts a keyframe together; its detections are numbered from 0 without a gap.
fn keyframe_row(
    row: &Row,
    features_row: Option<&Row>,
    detection_rows: &[Row],
) -> Result<KeyframeRow, StoreError> {
    let mut detections = Vec::with_capacity(detection_rows.len());
    for (expected, row) in (0_i64..).zip(detection_rows) {
        if row.try_get::<i64, _>("detection")? != expected {
            return Err(StoreError::corrupt(format!("detection {expected} is not there")));
        }
        let of_row = |error: StoreError| error.of_row(format!("detection {expected}"));
        let found = detection(row).map_err(of_row)?;
        detections.push(DetectionRow { has_crop: row.try_get("has_crop")?, ..found });
    }
    Ok(KeyframeRow {
        bow: decode::bow(row)?,
        features: features_row.map(features).transpose().map_err(|error| error.of_row("the features"))?,
        sent_points: sent_points(row)?,
        detections,
        digest: row.try_get("digest")?,
    })
}

/// Whether a kept answer is JSON with this id.
pub(crate) fn names_itself(id: &str, body: &[u8]) -> bool {
    let body: Option<serde_json::Value> = serde_json::from_slice(body).ok();
    body.is_some_and(|body| body["id"] == *id)
}

pub(crate) fn sent_points(row: &Row) -> Result<Vec<PointId>, StoreError> {
    integers_of(row.try_get("sent_points")?)
}

pub(crate) fn features(row: &Row) -> Result<Features, StoreError> {
    let keypoints = keypoints_of(row.try_get("keypoints")?)?;
    let map_points: Vec<i64> = integers_of(row.try_get("map_points")?)?;
    let descriptor_bytes = row.try_get::<u32, _>("descriptor_bytes")? as usize;
    let descriptors: Vec<u8> = row.try_get("descriptors")?;
    if map_points.len() != keypoints.len() || descriptors.len() != descriptor_bytes * keypoints.len() {
        return Err(StoreError::corrupt("the lists do not fit together"));
    }
    Ok(Features {
        descriptor_bytes,
        descriptors,
        keypoints,
        map_points: map_points.into_iter().map(|id| (id >= 0).then_some(id)).collect(),
    })
}

/// Reads a detection; its crop has rows of its own.
pub(crate) fn detection(row: &Row) -> Result<DetectionRow, StoreError> {
    let outcome: &str = row.try_get("outcome")?;
    let outcome = match (outcome, row.try_get("anchor")?) {
        ("created", Some(anchor)) => Outcome::Created(anchor),
        ("observed", Some(anchor)) => Outcome::Observed(anchor),
        (reason, _) => Outcome::Ignored(
            IgnoredReason::from_name(reason)
                .ok_or_else(|| StoreError::corrupt(format!("outcome {reason}")))?,
        ),
    };
    let detection = Detection {
        class: row.try_get("class")?,
        confidence: row.try_get("confidence")?,
        box_px: row.try_get("box_px")?,
        map_points: unpack(row.try_get("map_points")?)?,
        position_in_session: row.try_get("position")?,
        range_assumed: row.try_get("range_assumed")?,
        text: row.try_get("text")?,
        description: row.try_get("description")?,
        crop: None,
    };
    Ok(DetectionRow { has_crop: false, detection, outcome })
}

pub(crate) fn event(row: &Row) -> Result<Event, StoreError> {
    Ok(Event {
        seq: row.try_get("seq")?,
        kind: row.try_get("kind")?,
        map_version: row.try_get("map_version")?,
        told: Some(stamp_of_micros(row.try_get("told_us")?)),
        anchor: row.try_get("anchor")?,
        other: row.try_get("other")?,
        keyframe: row.try_get("keyframe")?,
        candidate: row.try_get("candidate")?,
        loop_id: row.try_get("loop_id")?,
        query: row.try_get("query")?,
        session: row.try_get("session")?,
        into: row.try_get("into_session")?,
        detail: row.try_get("detail")?,
    })
}
