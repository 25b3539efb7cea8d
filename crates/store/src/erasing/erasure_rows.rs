//! Erasures, as rows.

use revisit_core::domain::erasure::{Erasure, ErasureState, MergedInVersion, NewErasure};
use revisit_core::domain::ids::{MapId, ReleaseName, SessionId};
use revisit_core::domain::keyframe::Stamp;

use crate::columns::json;
use crate::map_key::MapKey;
use crate::sql::run;
use crate::sql::{self, Connection, Query, Row};
use crate::{Store, StoreError};

/// Erasures of a map that are kept on record, oldest out first.
const ERASURES_KEPT: i64 = 1000;

/// An erasure that was not done when the process ended, or is under way.
#[derive(Clone, Debug)]
pub struct OpenErasure {
    /// The map.
    pub map: MapId,
    /// Its key.
    pub key: MapKey,
    /// Its number in the map.
    pub number: u64,
    /// The keyframes or sessions to be removed; `None` once they are.
    pub asked: Option<NewErasure>,
    /// Whether it is counted what is to be removed; before that, nothing is.
    pub is_counted: bool,
}

/// Writes an erasure that begins.
pub(crate) async fn begin(
    db: &mut Connection,
    (map, number): (MapKey, u64),
    asked: &NewErasure,
    at: Stamp,
) -> Result<(), StoreError> {
    let (state, body) = (ErasureState::Removing, json::text(asked)?);
    let insert =
        "insert into erasures (map_key, number, state, asked, keyframes, releases, begun_sec, begun_nanosec)
        values ($1, $2, $3, $4, 0, 0, $5, $6)";
    run(db, sql::statement(insert, (map, number, state, body, at.sec, at.nanosec))).await?;
    let sweep = "delete from erasures where map_key = $1 and state = 'done' and number <= $2";
    run(db, sql::statement(sweep, (map, number as i64 - ERASURES_KEPT))).await
}

/// Counts the keyframes that are to be removed from the map, and the releases that some are to be removed from.
pub(crate) fn count((map, number): (MapKey, u64), (keyframes, releases): (u64, usize)) -> Query {
    let update = "update erasures set keyframes = $3, releases = $4 where map_key = $1 and number = $2";
    sql::statement(update, (map, number, keyframes, releases))
}

/// All is removed: from here on nothing names it.
pub(crate) fn removed((map, number): (MapKey, u64)) -> Query {
    let update = "update erasures set state = $3, asked = null where map_key = $1 and number = $2";
    sql::statement(update, (map, number, ErasureState::Rewriting))
}

/// The file was rewritten.
pub(crate) fn done((map, number): (MapKey, u64), at: Stamp) -> Query {
    let update = "update erasures set state = $3, ended_sec = $4, ended_nanosec = $5
        where map_key = $1 and number = $2";
    sql::statement(update, (map, number, ErasureState::Done, at.sec, at.nanosec))
}

impl Store {
    /// Returns an erasure of a map.
    pub async fn erasure(&self, map: MapKey, number: u64) -> Result<Option<Erasure>, StoreError> {
        let select = "select * from erasures where map_key = $1 and number = $2";
        let row = sql::query(select).bind(map).bind(number).fetch_optional(&self.readers).await?;
        row.as_ref().map(erasure).transpose()
    }

    /// Returns the number of the next erasure of a map.
    pub async fn next_erasure(&self, map: MapKey) -> Result<u64, StoreError> {
        let select = "select coalesce(max(number), 0) + 1 from erasures where map_key = $1";
        Ok(sql::query_scalar(select).bind(map).fetch_one(&self.readers).await?)
    }

    /// Returns the erasures that are not done, by map and number.
    pub async fn open_erasures(&self) -> Result<Vec<OpenErasure>, StoreError> {
        let select = "select m.id, e.map_key, e.number, e.asked, e.keyframes + e.releases
            from erasures e join maps m using (map_key)
            where e.state <> 'done' and m.deleted = 0 order by e.map_key, e.number";
        let rows: Vec<(_, _, _, Option<String>, i64)> =
            sql::query_as(select).fetch_all(&self.readers).await?;
        let open = |(map, key, number, asked, counted): (_, _, _, Option<String>, _)| {
            let asked = asked.as_deref().map(json::value).transpose()?;
            Ok(OpenErasure { map, key, number, asked, is_counted: counted > 0 })
        };
        rows.into_iter().map(open).collect()
    }

    /// Returns the keys of deleted maps of which rows are left.
    pub async fn deleted_maps(&self) -> Result<Vec<MapKey>, StoreError> {
        let select = "select map_key from maps where deleted = 1 order by map_key";
        Ok(sql::query_scalar(select).fetch_all(&self.readers).await?)
    }

    /// Returns the merges of sessions that the map or a release of it knows.
    pub async fn merges_of_versions(&self, map: MapKey) -> Result<Vec<MergedInVersion>, StoreError> {
        let select = "select r.name, s.id, i.id from session_merges m
            left join releases r on r.release_key = m.map_key
            join sessions s on s.map_key = m.map_key and s.session = m.session
            join sessions i on i.map_key = m.map_key and i.session = m.into_session
            where m.map_key = $1 or r.map_key = $1 order by m.map_key, m.version";
        let rows: Vec<(_, _, _)> = sql::query_as(select).bind(map).fetch_all(&self.readers).await?;
        let merge = |(release, session, into)| MergedInVersion { release, session, into };
        Ok(rows.into_iter().map(merge).collect())
    }

    /// Returns the sessions in whose frames the map or a release of it has prior anchors.
    pub async fn frames_of_plans(
        &self,
        map: MapKey,
    ) -> Result<Vec<(Option<ReleaseName>, SessionId)>, StoreError> {
        let select = "select distinct r.name, s.id from prior_anchors p
            left join releases r on r.release_key = p.map_key
            join sessions s on s.map_key = p.map_key and s.session = p.frame
            where p.map_key = $1 or r.map_key = $1";
        Ok(sql::query_as(select).bind(map).fetch_all(&self.readers).await?)
    }

    /// Whether changes of the map wait to be brought into their rows.
    pub async fn has_deferred_changes(&self, map: MapKey) -> Result<bool, StoreError> {
        let select = "select exists (select 1 from maps where map_key = $1 and waits_version is not null)";
        Ok(sql::query_scalar(select).bind(map).fetch_one(&self.readers).await?)
    }
}

fn erasure(row: &Row) -> Result<Erasure, StoreError> {
    let ended: Option<i64> = row.try_get("ended_sec")?;
    Ok(Erasure {
        number: row.try_get("number")?,
        state: row.try_get("state")?,
        keyframes: row.try_get("keyframes")?,
        releases: row.try_get("releases")?,
        begun: Stamp { sec: row.try_get("begun_sec")?, nanosec: row.try_get("begun_nanosec")? },
        ended: ended
            .map(|sec| Ok::<_, StoreError>(Stamp { sec, nanosec: row.try_get("ended_nanosec")? }))
            .transpose()?,
    })
}
