//! Followers: servers that keep a copy of a map that another one owns, and what they hand to it.

use std::time::Duration;

use revisit_core::domain::ids::MapId;

use super::key_list::list;
use crate::map_key::MapKey;
use crate::rows::verdict_rows::{GivenAnswer, line};
use crate::sql::{self, Row};
use crate::{Store, StoreError};

/// A server counts as a follower so long after it last said so.
const FOLLOWS: Duration = Duration::from_secs(15);

/// Answers of followers that wait for the owner of their map; further ones are not kept.
const ANSWERS_MAX: i64 = 1_000;

impl Store {
    /// Says that this server follows these maps, for a while.
    pub async fn follow(&self, maps: &[MapKey]) -> Result<(), StoreError> {
        let Some(leases) = &self.leases else { return Ok(()) };
        let upsert = "insert into map_followers (map_key, node, expires)
            select map_key, $1, clock_timestamp() + make_interval(secs => $3) from maps
            where deleted = 0 and map_key in (select cast(value as bigint) from json_each($2))
            on conflict (map_key, node) do update set expires = excluded.expires";
        let query = sql::query(upsert).bind(leases.node()).bind(list(maps)).bind(FOLLOWS.as_secs_f64());
        query.execute(leases.pool()).await?;
        let sweep = "delete from map_followers where expires < clock_timestamp()";
        sql::query(sweep).execute(leases.pool()).await?;
        Ok(())
    }

    /// Hands an answer to the owner of a map, which keeps it with its own. One of a copy from before the map was rewritten is not
    /// kept: it may tell what was erased since.
    pub async fn hand_answer_on(
        &self,
        map: MapKey,
        rewrites: i64,
        given: &GivenAnswer,
    ) -> Result<(), StoreError> {
        // A rewrite locks its row first: it waits for this, or this finds that it was.
        let insert = "insert into followed_queries
            (map_key, id, body, keyframe, candidate, map_version, verdict, reason, why)
            select m.map_key, $2, $3, $6, $7, $8, $9, $10, $11 from maps m join map_rewrites r using (map_key)
            where m.map_key = $1 and m.deleted = 0 and r.rewritten = $5
            and (select count(*) from followed_queries where map_key = $1) < $4 for share of r
            on conflict do nothing";
        let GivenAnswer { id, body, line } = given;
        let query = sql::query(insert).bind(map).bind(id).bind(body).bind(ANSWERS_MAX).bind(rewrites);
        let query = query.bind(line.keyframe.as_ref()).bind(line.candidate.as_ref()).bind(line.map_version);
        let query = query.bind(line.decision).bind(line.reason).bind(&line.why);
        query.execute(&self.readers).await?;
        Ok(())
    }

    /// Returns the answers that followers gave of a map that this server owns. They are its own from here on.
    pub async fn take_answers(&self, map: MapKey, at_most: u32) -> Result<Vec<GivenAnswer>, StoreError> {
        let take = "delete from followed_queries where map_key = $1 and id in
            (select id from followed_queries where map_key = $1 order by id limit $2)
            returning id, body, keyframe, candidate, map_version, verdict, reason, why";
        let rows = sql::query(take).bind(map).bind(at_most).fetch_all(&self.readers).await?;
        let given = |row: &Row| {
            let body: Vec<u8> = row.try_get("body")?;
            Ok(GivenAnswer { id: row.try_get("id")?, line: line(row)?, body: body.into() })
        };
        rows.iter().map(given).collect()
    }

    /// Returns an answer of a follower that is on its way to the owner of the map, or of a release of the map.
    pub async fn answer_on_its_way(&self, map: MapKey, id: &str) -> Result<Option<Vec<u8>>, StoreError> {
        if self.leases.is_none() {
            return Ok(None);
        }
        let select = "select body from followed_queries where id = $2
            and map_key in (select $1 union all select release_key from releases where map_key = $1) limit 1";
        Ok(sql::query_scalar(select).bind(map).bind(id).fetch_optional(&self.readers).await?)
    }

    /// Returns the maps, releases among them, that have answers of followers.
    pub async fn maps_with_answers(&self) -> Result<Vec<MapId>, StoreError> {
        if self.leases.is_none() {
            return Ok(Vec::new());
        }
        let select = "select id from maps where deleted = 0
            and map_key in (select distinct map_key from followed_queries) order by id";
        Ok(sql::query_scalar(select).fetch_all(&self.readers).await?)
    }
}
