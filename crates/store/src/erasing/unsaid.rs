//! Unsaid: verdicts and readings that newer ones replaced. The log keeps them, so that older answers stay
//! explained.

use futures_util::TryStreamExt as _;
use revisit_core::domain::change::Change;
use revisit_core::domain::judged::{CropRead, ModelVerdict};
use revisit_core::domain::judgement::Replaced;

use crate::log::entry::{Entry, Unsaid};
use crate::map_key::MapKey;
use crate::rows::model_rows::{dialogue, reading_of, verdict_about};
use crate::sql::{self, Connection};
use crate::{Store, StoreError};

/// Returns what these changes are about to replace of what models said.
pub(crate) async fn by(
    db: &mut Connection,
    map: MapKey,
    changes: &[Change],
) -> Result<Vec<Unsaid>, StoreError> {
    let mut unsaid = Vec::new();
    for change in changes {
        match change {
            Change::Judged(verdict) => {
                unsaid.extend(verdict_about(db, map, verdict).await?.map(Unsaid::Verdict));
            }
            Change::CropRead(read) => {
                let at = (read.keyframe, read.detection);
                let Some((reading, fingerprint)) = reading_of(db, map, at).await? else { continue };
                let transcript = dialogue(db, map, at).await?;
                let before = CropRead { reading, transcript, fingerprint, ..(**read).clone() };
                unsaid.push(Unsaid::Reading(before));
            }
            _ => {}
        }
    }
    Ok(unsaid)
}

impl Store {
    /// Returns the verdicts that were replaced by others after a version of the map, the newest first, at most `limit`.
    pub async fn replaced(
        &self,
        map: MapKey,
        since_version: u64,
        limit: usize,
    ) -> Result<Vec<Replaced>, StoreError> {
        let mut db = self.snapshot().await?;
        let select = "select version, body from versions
            where map_key = $1 and version > $2 and part < 0 order by version desc limit $3";
        let query = sql::query(select).bind(map).bind(since_version).bind(limit);
        let mut rows = Vec::new();
        let mut found = query.fetch(&mut db);
        while let Some(row) = found.try_next().await? {
            rows.push((row.try_get("version")?, Entry::of(row.try_get("body")?)?.unsaid));
        }
        drop(found);
        let mut replaced = Vec::new();
        for (map_version, unsaid) in rows {
            for before in unsaid {
                let now = match before {
                    Unsaid::Verdict(before) => of_texts(&mut db, map, before).await?,
                    Unsaid::Reading(before) => of_crop(&mut db, map, before).await?,
                };
                replaced.extend(now.map(|now| Replaced { map_version, ..now }));
            }
        }
        db.commit().await?;
        replaced.truncate(limit);
        Ok(replaced)
    }
}

/// Returns a verdict beside the one that stands now, if that says another thing.
async fn of_texts(
    db: &mut Connection,
    map: MapKey,
    before: ModelVerdict,
) -> Result<Option<Replaced>, StoreError> {
    let now = verdict_about(db, map, &before).await?;
    let Some(now) = now.filter(|now| now.finding != before.finding) else { return Ok(None) };
    let said = |verdict: &ModelVerdict| (verdict.finding.to_string(), verdict.source.to_string());
    Ok(Some(Replaced {
        map_version: 0,
        operation: before.finding.operation().to_owned(),
        before: said(&before),
        after: said(&now),
        class: before.class.into(),
        texts: [before.a, before.b].into_iter().filter(|text| !text.is_empty()).map(Into::into).collect(),
        crop: None,
    }))
}

/// Returns a reading beside the one that stands now, if that is another text of a keyframe that is still there.
async fn of_crop(db: &mut Connection, map: MapKey, before: CropRead) -> Result<Option<Replaced>, StoreError> {
    let at = (before.keyframe, before.detection);
    let Some((now, _)) = reading_of(db, map, at).await? else { return Ok(None) };
    if now.text == before.reading.text {
        return Ok(None);
    }
    let select = "select d.class, k.id from detections d join keyframes k using (map_key, keyframe)
        where map_key = $1 and keyframe = $2 and detection = $3";
    let query = sql::query_as(select).bind(map).bind(at.0).bind(at.1);
    let found: Option<(String, String)> = query.fetch_optional(db).await?;
    Ok(found.map(|(class, keyframe)| Replaced {
        map_version: 0,
        operation: "describe".to_owned(),
        class,
        texts: Vec::new(),
        crop: Some((keyframe, at.1)),
        before: (before.reading.text.into(), before.reading.source.to_string()),
        after: (now.text.into(), now.source.to_string()),
    }))
}
