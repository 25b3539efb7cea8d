//! Rows of one map that its index does not hold: they decode, and events and detections are numbered without a gap.

use futures_util::TryStreamExt as _;
use revisit_core::domain::keyframe::{Crop, Features};
use revisit_core::domain::request::Digest;

use crate::StoreError;
use crate::facts::MapFacts;
use crate::loading::read;
use crate::log::entry::Entry;
use crate::map_key::MapKey;
use crate::sql::{self, Connection};

/// Whether features fit together, so that they can be matched.
pub(super) type Fit = fn(Features) -> bool;

/// Findings in a map's rows.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RowFindings {
    /// Its events that are kept.
    pub events: u64,
    /// Its faults.
    pub faults: Vec<String>,
}

/// Checks the rows of a map that was loaded.
pub(super) async fn check(
    db: &mut Connection,
    facts: &MapFacts,
    fit: Fit,
    found: &mut RowFindings,
) -> Result<(), StoreError> {
    let key = facts.key;
    events(&mut *db, facts, found).await?;
    keyframes(&mut *db, key, fit, &mut found.faults).await?;
    detections(&mut *db, key, &mut found.faults).await?;
    crops(&mut *db, key, &mut found.faults).await?;
    log(&mut *db, facts, &mut found.faults).await?;
    queries(&mut *db, key, &mut found.faults).await
}

/// Events follow each other without a gap up to the one that is given next, and none is of a version to come.
async fn events(db: &mut Connection, facts: &MapFacts, found: &mut RowFindings) -> Result<(), StoreError> {
    let mut expected: Option<u64> = None;
    let mut version = 0;
    let mut rows =
        sql::query("select * from events where map_key = $1 order by seq").bind(facts.key).fetch(db);
    while let Some(row) = rows.try_next().await? {
        let event = match read::event(&row) {
            Ok(event) => event,
            Err(error) => {
                found.faults.push(error.to_string());
                continue;
            }
        };
        found.events += 1;
        if expected.is_some_and(|expected| expected != event.seq) {
            found.faults.push(format!("event {} follows upon {}", event.seq, expected.unwrap_or(0) - 1));
        }
        if event.map_version < version || event.map_version > facts.version {
            found.faults.push(format!("event {} is of version {}", event.seq, event.map_version));
        }
        (expected, version) = (Some(event.seq + 1), event.map_version);
    }
    // Only the oldest are ever taken out. A map's first number is free: it is above those of maps that were deleted.
    let next = expected.unwrap_or(facts.next_event);
    if next != facts.next_event {
        found.faults.push(format!("the last event is {}, and {} is given next", next - 1, facts.next_event));
    }
    Ok(())
}

/// Everything of a keyframe that its map's index does not hold.
async fn keyframes(
    db: &mut Connection,
    key: MapKey,
    fit: Fit,
    faults: &mut Vec<String>,
) -> Result<(), StoreError> {
    let select = "select id, sent_points, digest, descriptor_bytes, descriptors, keypoints,
        keyframe_features.map_points from keyframes
        left join keyframe_features using (map_key, keyframe) where map_key = $1";
    let mut rows = sql::query(select).bind(key).fetch(db);
    while let Some(row) = rows.try_next().await? {
        let id: String = row.try_get("id")?;
        let mut note = |result: Result<bool, StoreError>, what: &str| match result {
            Ok(true) => {}
            Ok(false) => faults.push(format!("{what} of keyframe {id} do not fit together")),
            Err(error) => faults.push(format!("{what} of keyframe {id}: {error}")),
        };
        let digest: Result<Digest, _> = row.try_get("digest");
        note(digest.map(|_| true).map_err(Into::into), "the digest");
        note(read::sent_points(&row).map(|_| true), "the sent points");
        if row.try_get::<Option<&[u8]>, _>("descriptors")?.is_some() {
            note(read::features(&row).map(fit), "the features");
        }
    }
    Ok(())
}

/// A keyframe's detections are numbered from 0, and each is of its anchor's class.
async fn detections(db: &mut Connection, key: MapKey, faults: &mut Vec<String>) -> Result<(), StoreError> {
    let select = "select detections.*, anchors.class as anchor_class from detections
        left join anchors using (map_key, anchor) where map_key = $1 order by keyframe, detection";
    let mut rows = sql::query(select).bind(key).fetch(db);
    let mut last: Option<(i64, i64)> = None;
    while let Some(row) = rows.try_next().await? {
        let at: (i64, i64) = (row.try_get("keyframe")?, row.try_get("detection")?);
        let expected = last.filter(|last| last.0 == at.0).map_or(0, |last| last.1 + 1);
        if at.1 != expected {
            faults.push(format!("detection {expected} of keyframe number {} is not there", at.0));
        }
        last = Some(at);
        if let Err(error) = read::detection(&row) {
            faults.push(format!("detection {} of keyframe number {}: {error}", at.1, at.0));
        }
        let of_anchor: Option<&str> = row.try_get("anchor_class")?;
        if of_anchor.is_some_and(|class| row.try_get("class").is_ok_and(|own: &str| own != class)) {
            faults.push(format!(
                "detection {} of keyframe number {} is of another class than its anchor",
                at.1, at.0
            ));
        }
    }
    Ok(())
}

/// The log, which no index holds: it is read, and none of it is of a version to come.
async fn log(db: &mut Connection, facts: &MapFacts, faults: &mut Vec<String>) -> Result<(), StoreError> {
    let select = "select version, part, body from versions where map_key = $1 order by version, part";
    let mut rows = sql::query(select).bind(facts.key).fetch(db);
    let mut last = 0;
    while let Some(row) = rows.try_next().await? {
        let (version, part): (i64, i64) = (row.try_get("version")?, row.try_get("part")?);
        if let Err(error) = Entry::of(row.try_get("body")?) {
            faults.push(format!("part {part} of version {version}: {error}"));
        }
        last = version.unsigned_abs();
    }
    if last > facts.version {
        faults.push(format!("the log has version {last}, and the map's is {}", facts.version));
    }
    Ok(())
}

async fn crops(db: &mut Connection, key: MapKey, faults: &mut Vec<String>) -> Result<(), StoreError> {
    let select =
        "select keyframe, detection, media_type, substr(bytes, 1, 8) as head from crops where map_key = $1";
    let mut rows = sql::query(select).bind(key).fetch(db);
    while let Some(row) = rows.try_next().await? {
        let (keyframe, detection): (i64, i64) = (row.try_get("keyframe")?, row.try_get("detection")?);
        if Crop::media_type_of(row.try_get("head")?) != row.try_get("media_type").ok() {
            faults.push(format!(
                "the crop of detection {detection} of keyframe number {keyframe} is no such image"
            ));
        }
    }
    Ok(())
}

/// The kept answers are JSON that names itself.
async fn queries(db: &mut Connection, key: MapKey, faults: &mut Vec<String>) -> Result<(), StoreError> {
    let select = "select id, body from loop_queries where map_key = $1 and body is not null";
    let mut rows = sql::query(select).bind(key).fetch(db);
    while let Some(row) = rows.try_next().await? {
        let id: String = row.try_get("id")?;
        if !read::names_itself(&id, row.try_get("body")?) {
            faults.push(format!("the answer of loop query {id} is damaged"));
        }
    }
    Ok(())
}
