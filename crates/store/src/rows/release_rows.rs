//! Releases, as rows, and who asked them.

use std::collections::HashMap;

use revisit_core::domain::ids::{MapId, ReleaseName};
use revisit_core::domain::keyframe::Stamp;
use revisit_core::domain::release::{Release, ReleaseUse};
use revisit_core::domain::request::Digest;

use crate::columns::bulk_insert::write_rows;
use crate::jobs::job::CopiedAs;
use crate::log::log_rows::{self, FIRST_PART};
use crate::log::parts::Part;
use crate::map_key::MapKey;
use crate::rows::map_rows;
use crate::sql::run;
use crate::sql::{self, Connection, Query, Row};
use crate::{Store, StoreError};

/// Robots that a release's list names, at most; those that asked longest ago are left out first.
pub const RELEASE_USES_MAX: i64 = 1000;

/// Gives a copy its name: a release of the map that it was copied from, or a map of its own.
pub(crate) async fn finish_copy(
    db: &mut Connection,
    copy: MapKey,
    copied_as: &CopiedAs,
) -> Result<(), StoreError> {
    match copied_as {
        CopiedAs::Release { map, of, name, version, description, published, digest } => {
            let update = "update maps set deleted = 0, id = $2 where map_key = $1";
            run(db, sql::statement(update, (copy, &of.of_release(name)))).await?;
            let insert =
                "insert into releases (map_key, name, release_key, map_version, description, published_sec,
                published_nanosec, digest) values ($1, $2, $3, $4, $5, $6, $7, $8)";
            let Stamp { sec, nanosec } = *published;
            let values = (map, name, copy, *version, description, sec, nanosec, digest);
            run(db, sql::statement(insert, values)).await
        }
        CopiedAs::Itself { id } => {
            let update = "update maps set deleted = 0, id = $2 where map_key = $1 and deleted = 2";
            if sql::statement(update, (copy, id)).execute(&mut *db).await? == 0 {
                return Err(StoreError::corrupt(format!("the copy of map {id} was thrown away")));
            }
            Ok(())
        }
        CopiedAs::Map { id, properties, version, digest, owner } => {
            // As a map that was just made: its events are numbered from above those of every map that was deleted.
            let update = "update maps set deleted = 0, id = $2, version = $3, digest = $4, owner = $5,
                next_event = (select last + 1 from counters where name = 'event') where map_key = $1";
            run(db, sql::statement(update, (copy, id, *version, digest, *owner))).await?;
            run(db, sql::statement("delete from fleet_frames where map_key = $1", (copy,))).await?;
            run(db, map_rows::set_properties(copy, properties)?).await?;
            log_rows::add(db, (copy, *version), FIRST_PART, &Part::setting(properties)).await
        }
    }
}

/// Counts queries of robots. The release may be gone by now: then there is nothing to count.
pub(crate) async fn count_uses(
    db: &mut Connection,
    release: MapKey,
    uses: &[ReleaseUse],
) -> Result<(), StoreError> {
    let head = "insert into release_uses (map_key, session, queries, last_sec, last_nanosec)
        select column1, column2, column3, column4, column5 from (";
    let tail = ") as given where exists (select 1 from maps where map_key = column1 and deleted = 0)
        on conflict (map_key, session) do update set queries = release_uses.queries + excluded.queries,
            last_sec = excluded.last_sec, last_nanosec = excluded.last_nanosec";
    write_rows(db, head, tail, uses, |row, of| {
        row.push_bind(release).push_bind(&of.session).push_bind(of.queries);
        row.push_bind(of.last.sec).push_bind(of.last.nanosec);
    })
    .await?;
    let sweep = "delete from release_uses where map_key = $1 and session not in (
        select session from release_uses where map_key = $1 order by last_sec desc, last_nanosec desc, session limit $2
    ) and (select count(*) from release_uses where map_key = $1) > $2";
    run(db, sql::statement(sweep, (release, RELEASE_USES_MAX))).await
}

/// Keyframes were erased from a release.
pub(crate) fn count_erasure(release: MapKey) -> Query {
    sql::statement("update releases set erasures = erasures + 1 where release_key = $1", (release,))
}

impl Store {
    /// Returns the releases of a map by name, after one.
    pub async fn releases(
        &self,
        map: MapKey,
        after: Option<&ReleaseName>,
        limit: usize,
    ) -> Result<Vec<Release>, StoreError> {
        let select = "select r.*, m.keyframes, m.anchors, m.sessions, m.loops, m.bytes
            from releases r join maps m on m.map_key = r.release_key
            where r.map_key = $1 and r.name > $2 order by r.name limit $3";
        let after = after.map_or("", ReleaseName::as_str);
        let query = sql::query(select).bind(map).bind(after).bind(limit);
        self.with_uses(&query.fetch_all(&self.readers).await?).await
    }

    /// Returns a release of a map, with the digest of the request that published it.
    pub async fn release(
        &self,
        map: MapKey,
        name: &ReleaseName,
    ) -> Result<Option<(Release, Digest)>, StoreError> {
        let select = "select r.*, m.keyframes, m.anchors, m.sessions, m.loops, m.bytes
            from releases r join maps m on m.map_key = r.release_key where r.map_key = $1 and r.name = $2";
        let query = sql::query(select).bind(map).bind(name);
        let Some(row) = query.fetch_optional(&self.readers).await? else { return Ok(None) };
        let digest = row.try_get("digest")?;
        let found = self.with_uses(&[row]).await?.pop();
        Ok(found.map(|release| (release, digest)))
    }

    /// Returns the number of releases of a map, and what they take on disk in bytes, as quotas count it.
    pub async fn release_sizes(&self, map: MapKey) -> Result<(u64, u64), StoreError> {
        let select = "select count(*), cast(coalesce(sum(m.bytes), 0) as bigint)
            from releases r join maps m on m.map_key = r.release_key where r.map_key = $1";
        Ok(sql::query_as(select).bind(map).fetch_one(&self.readers).await?)
    }

    /// Returns the ids of the maps that hold the releases of a map, with their keys.
    pub async fn release_maps(&self, map: MapKey) -> Result<Vec<(MapId, MapKey)>, StoreError> {
        let select = "select m.id, m.map_key from releases r join maps m on m.map_key = r.release_key
            where r.map_key = $1 order by r.name";
        Ok(sql::query_as(select).bind(map).fetch_all(&self.readers).await?)
    }

    async fn with_uses(&self, rows: &[Row]) -> Result<Vec<Release>, StoreError> {
        let keys = rows.iter().map(|row| row.try_get::<MapKey, _>("release_key"));
        let keys: Vec<MapKey> = keys.collect::<Result<_, _>>()?;
        let text = serde_json::to_string(&keys).map_err(|error| StoreError::Database(error.to_string()))?;
        let select =
            "select * from release_uses where map_key in (select cast(value as bigint) from json_each($1))
            order by last_sec desc, last_nanosec desc, session";
        let mut uses: HashMap<MapKey, Vec<ReleaseUse>> = HashMap::new();
        for row in sql::query(select).bind(text).fetch_all(&self.readers).await? {
            uses.entry(row.try_get("map_key")?).or_default().push(release_use(&row)?);
        }
        let with_uses = |(row, key)| release(row, uses.remove(key).unwrap_or_default());
        rows.iter().zip(&keys).map(with_uses).collect()
    }
}

fn release(row: &Row, uses: Vec<ReleaseUse>) -> Result<Release, StoreError> {
    Ok(Release {
        name: row.try_get("name")?,
        description: row.try_get("description")?,
        version: row.try_get("map_version")?,
        published: Stamp { sec: row.try_get("published_sec")?, nanosec: row.try_get("published_nanosec")? },
        figures: map_rows::figures(row)?,
        erasures: row.try_get("erasures")?,
        uses,
    })
}

fn release_use(row: &Row) -> Result<ReleaseUse, StoreError> {
    Ok(ReleaseUse {
        session: row.try_get("session")?,
        queries: row.try_get("queries")?,
        last: Stamp { sec: row.try_get("last_sec")?, nanosec: row.try_get("last_nanosec")? },
    })
}
