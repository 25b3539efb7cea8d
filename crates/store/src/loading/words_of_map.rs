//! The words of a map that is not in memory, read past its index: is it worth loading?

use revisit_core::domain::bow::{BowVector, Score};
use revisit_core::domain::ids::MapId;

use crate::loading::load::Db;
use crate::map_key::MapKey;
use crate::rows::decode;
use crate::sql;
use crate::{Store, StoreError};

/// Rows read at a time.
const CHUNK: i64 = 256;

/// The facts of a map that decide whether its words are to be read.
#[derive(Clone, Debug)]
pub struct MapOutline {
    key: MapKey,
    /// Its version.
    pub version: u64,
    /// The vocabulary of its words, once it has any.
    pub vocabulary: Option<String>,
    /// Whether it has anchors, seen ones or prior ones.
    pub has_anchors: bool,
    /// Whether a keyframe has a global descriptor.
    pub has_globals: bool,
    /// The memory that its index took when it was last written to, in bytes.
    pub memory_bytes: u64,
}

impl Store {
    /// Returns a map's outline, and the best score of these vectors against its keyframes, both of one version. Nothing is
    /// scored where `is_wanted` says no. Returns `None` if there is no such map.
    pub async fn best_score(
        &self,
        id: &MapId,
        vectors: &[&BowVector],
        is_wanted: impl Fn(&MapOutline) -> bool,
    ) -> Result<Option<(MapOutline, Score)>, StoreError> {
        let mut db = self.snapshot().await?;
        let Some(outline) = outline(&mut db, id).await? else { return Ok(None) };
        let mut best = Score::default();
        if is_wanted(&outline) {
            best = best_score(&mut db, outline.key, vectors).await.map_err(|error| error.of_map(id))?;
        }
        db.commit().await?;
        Ok(Some((outline, best)))
    }
}

async fn outline(db: &mut Db, id: &MapId) -> Result<Option<MapOutline>, StoreError> {
    let select = "select map_key, version, vocabulary, memory_bytes, \
         exists (select 1 from anchors where anchors.map_key = maps.map_key) as has_anchors, \
         exists (select 1 from keyframes where keyframes.map_key = maps.map_key and global_model is not null) as has_globals \
         from maps where id = $1 and deleted = 0";
    let row = sql::query(select).bind(id).fetch_optional(&mut *db).await?;
    let Some(row) = row else { return Ok(None) };
    Ok(Some(MapOutline {
        key: row.try_get("map_key")?,
        version: row.try_get("version")?,
        vocabulary: row.try_get("vocabulary")?,
        has_anchors: row.try_get("has_anchors")?,
        has_globals: row.try_get("has_globals")?,
        memory_bytes: row.try_get("memory_bytes")?,
    }))
}

async fn best_score(db: &mut Db, map: MapKey, vectors: &[&BowVector]) -> Result<Score, StoreError> {
    let select = "select keyframe, bow_words, bow_weights from keyframes \
         where map_key = $1 and keyframe > $2 order by keyframe limit $3";
    let (mut best, mut last) = (Score::default(), -1_i64);
    loop {
        let rows = sql::query(select).bind(map).bind(last).bind(CHUNK).fetch_all(&mut *db).await?;
        let Some(row) = rows.last() else { return Ok(best) };
        last = row.try_get("keyframe")?;
        for row in &rows {
            let number: i64 = row.try_get("keyframe")?;
            let bow = decode::bow(row).map_err(|error| error.of_row(format!("keyframe number {number}")))?;
            best = vectors.iter().map(|vector| vector.similarity(&bow)).fold(best, Score::max);
        }
    }
}
