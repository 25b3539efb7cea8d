//! The words of a map that is not in memory, read past its index: is it worth loading?

use sqlx::Row;

use super::decode;
use crate::domain::bow::{BowVector, Score};
use crate::domain::ids::{KeyframeId, KeyframeSeq, MapId};
use crate::store::commit::job::MapKey;
use crate::store::rows::load::Db;
use crate::store::{Store, StoreError};

/// Rows read at a time.
const CHUNK: i64 = 256;

/// What a map holds besides words.
#[derive(Clone, Debug)]
pub struct MapOutline {
    /// Its number.
    pub key: MapKey,
    /// Its version.
    pub version: u64,
    /// The vocabulary of its words, once it has any.
    pub vocabulary: Option<String>,
    /// Whether it has anchors, seen ones or prior ones.
    pub has_anchors: bool,
    /// Whether a keyframe has a global descriptor.
    pub has_globals: bool,
}

/// The keyframe of a map whose words are most like a vector.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MostAlike {
    /// The keyframe.
    pub keyframe: KeyframeSeq,
    /// Its name, which orders equal scores.
    pub id: KeyframeId,
    /// Its score, above 0.
    pub score: Score,
}

/// What is sought in a map that is not in memory.
#[derive(Clone, Copy, Debug)]
pub struct WordsSought<'a> {
    /// The vectors.
    pub vectors: &'a [BowVector],
    /// Whether only keyframes with a camera count.
    pub must_have_camera: bool,
}

impl Store {
    /// Returns what a map holds besides words, and for each vector the keyframe whose words are most like it, ties to the
    /// smallest name; `None` where no keyframe has a word in common with it. All of one version. Nothing is sought where
    /// `is_wanted` says no. Returns `None` if there is no such map.
    pub async fn most_alike(
        &self,
        id: &MapId,
        sought: WordsSought<'_>,
        is_wanted: impl Fn(&MapOutline) -> bool,
    ) -> Result<Option<(MapOutline, Vec<Option<MostAlike>>)>, StoreError> {
        let mut db = self.snapshot().await?;
        let Some(outline) = outline(&mut db, id).await? else { return Ok(None) };
        let found = if is_wanted(&outline) {
            most_alike(&mut db, outline.key, sought).await.map_err(|error| error.of_map(id))?
        } else {
            vec![None; sought.vectors.len()]
        };
        db.commit().await?;
        Ok(Some((outline, found)))
    }
}

async fn outline(db: &mut Db, id: &MapId) -> Result<Option<MapOutline>, StoreError> {
    let select = "select map_key, version, vocabulary, \
         exists (select 1 from anchors where anchors.map_key = maps.map_key) as has_anchors, \
         exists (select 1 from keyframes where keyframes.map_key = maps.map_key and global_model is not null) as has_globals \
         from maps where id = $1 and deleted = 0";
    let row = sqlx::query(select).bind(id.as_str()).fetch_optional(&mut *db).await?;
    let Some(row) = row else { return Ok(None) };
    Ok(Some(MapOutline {
        key: row.try_get("map_key")?,
        version: row.try_get::<i64, _>("version")? as u64,
        vocabulary: row.try_get("vocabulary")?,
        has_anchors: row.try_get("has_anchors")?,
        has_globals: row.try_get("has_globals")?,
    }))
}

async fn most_alike(
    db: &mut Db,
    map: MapKey,
    sought: WordsSought<'_>,
) -> Result<Vec<Option<MostAlike>>, StoreError> {
    let select = "select keyframe, id, camera is not null as has_camera, bow_words, bow_weights, packing from keyframes \
         where map_key = $1 and keyframe > $2 order by keyframe limit $3";
    let mut best: Vec<Option<MostAlike>> = vec![None; sought.vectors.len()];
    let mut last = -1_i64;
    loop {
        let rows = sqlx::query(select).bind(map).bind(last).bind(CHUNK).fetch_all(&mut *db).await?;
        let Some(row) = rows.last() else { return Ok(best) };
        last = row.try_get("keyframe")?;
        for row in &rows {
            if sought.must_have_camera && !row.try_get::<bool, _>("has_camera")? {
                continue;
            }
            let number: i64 = row.try_get("keyframe")?;
            let keyframe = KeyframeSeq(number as u32);
            let bow = decode::bow(row).map_err(|error| error.of_row(format!("keyframe number {number}")))?;
            let id: KeyframeId = decode::id(row.try_get("id")?)?;
            for (vector, best) in sought.vectors.iter().zip(&mut best) {
                let score = vector.similarity(&bow);
                let is_better =
                    best.as_ref().is_none_or(|best| (score.units(), &best.id) > (best.score.units(), &id));
                if score.units() > 0 && is_better {
                    *best = Some(MostAlike { keyframe, id: id.clone(), score });
                }
            }
        }
    }
}
