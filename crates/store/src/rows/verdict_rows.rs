//! The rows of verdicts: answers of loop queries, whole while they are new, and a line of each for long.

use revisit_core::domain::reason::ReasonCode;
use revisit_core::domain::verdict::Decision;
use revisit_core::domain::verdict_line::{ListedVerdict, VerdictFilter, VerdictLine};

use crate::columns::bulk_insert::write_rows;
use crate::columns::clock::{micros_now, stamp_of_micros};
use crate::map_key::MapKey;
use crate::sql::run;
use crate::sql::{self, Connection, Row};
use crate::{Store, StoreError};

/// Whole answers of a map are kept up to this number, oldest out first.
const WHOLE_KEPT: i64 = 1_000;

/// Lines of a map are kept up to this number, oldest out first.
const LINES_KEPT: i64 = 100_000;

/// Rows between two removals of old ones.
const SWEPT_EVERY: i64 = 16;

/// The answer of a loop query, to be kept.
pub(crate) struct KeptQuery<'j> {
    pub map: MapKey,
    pub id: &'j str,
    /// Its number in the map, by age.
    pub kept: i64,
    pub line: &'j VerdictLine,
    pub body: &'j [u8],
}

/// An answer that a server gave of a map, with what names it.
#[derive(Clone, Debug)]
pub struct GivenAnswer {
    /// The query's id.
    pub id: String,
    /// The line that a list shows of it.
    pub line: VerdictLine,
    /// The answer, as sent.
    pub body: bytes::Bytes,
}

/// Writes answers with their lines, and takes out what is too old.
pub(crate) async fn keep(db: &mut Connection, queries: &[KeptQuery<'_>]) -> Result<(), StoreError> {
    // A map may be gone by now: then there is nothing to keep.
    let head = "insert into loop_queries
        (map_key, id, kept, asked_us, keyframe, candidate, map_version, verdict, reason, why, body)
        select column1, column2, column3, column4, column5, column6, column7, column8, column9, column10, column11 from (";
    let tail = ") as given where exists (select 1 from maps where map_key = column1 and deleted = 0)
        on conflict (map_key, id) do update
        set kept = excluded.kept, asked_us = excluded.asked_us, body = excluded.body";
    let now = micros_now();
    write_rows(db, head, tail, queries, |row, query| {
        let VerdictLine { keyframe, candidate, map_version, decision, reason, why } = query.line;
        row.push_bind(query.map).push_bind(query.id).push_bind(query.kept).push_bind(now);
        row.push_bind(keyframe.as_ref()).push_bind(candidate.as_ref()).push_bind(*map_version);
        row.push_bind(*decision).push_bind(*reason).push_bind(why).push_bind(query.body);
    })
    .await?;
    for query in queries.iter().filter(|query| query.kept % SWEPT_EVERY == 0) {
        // Looks back as far as several removals that were missed.
        let forget = "update loop_queries set body = null
            where map_key = $1 and kept > $2 and kept <= $3 and body is not null";
        let oldest = query.kept - WHOLE_KEPT + SWEPT_EVERY;
        let from = oldest - 8 * SWEPT_EVERY;
        run(db, sql::statement(forget, (query.map, from, oldest))).await?;
        let sweep = "delete from loop_queries where map_key = $1 and kept <= $2";
        run(db, sql::statement(sweep, (query.map, query.kept - LINES_KEPT + SWEPT_EVERY))).await?;
    }
    Ok(())
}

impl Store {
    /// Returns the lines of a map's verdicts before one, the newest first, each with its number.
    pub async fn verdicts(
        &self,
        map: MapKey,
        filter: &VerdictFilter,
        before: i64,
        limit: usize,
    ) -> Result<Vec<(i64, ListedVerdict)>, StoreError> {
        let select = "select q.kept, q.id, q.asked_us, q.keyframe, q.candidate, q.map_version, q.verdict, q.reason, q.why,
            case when q.body is null then 0 else 1 end as is_whole, s.id as session
            from loop_queries q
            left join keyframes k on k.map_key = q.map_key and k.id = q.keyframe
            left join sessions s on s.map_key = k.map_key and s.session = k.session
            where q.map_key = $1 and q.kept < $2
            and ($3 = '' or q.verdict = $3) and ($4 = '' or q.reason = $4) and ($5 = '' or s.id = $5)
            and q.asked_us >= $6 and q.asked_us < $7
            order by q.kept desc limit $8";
        let micros = |seconds: i64| seconds.saturating_mul(1_000_000);
        let query = sql::query(select)
            .bind(map)
            .bind(before)
            .bind(filter.decision.map_or("", Decision::as_str))
            .bind(filter.reason.map_or("", ReasonCode::as_str))
            .bind(filter.session.as_ref().map_or("", |session| session.as_str()))
            .bind(filter.since_s.map_or(0, micros))
            .bind(filter.until_s.map_or(i64::MAX, micros))
            .bind(limit);
        let rows = query.fetch_all(&self.readers).await?;
        let found = rows.iter().map(listed).collect();
        self.of_map(map, found).await
    }
}

fn listed(row: &Row) -> Result<(i64, ListedVerdict), StoreError> {
    let listed = ListedVerdict {
        query: row.try_get("id")?,
        asked: stamp_of_micros(row.try_get("asked_us")?),
        session: row.try_get("session")?,
        is_whole: row.try_get("is_whole")?,
        line: line(row)?,
    };
    Ok((row.try_get("kept")?, listed))
}

/// Reads the columns of a line.
pub(crate) fn line(row: &Row) -> Result<VerdictLine, StoreError> {
    Ok(VerdictLine {
        keyframe: row.try_get("keyframe")?,
        candidate: row.try_get("candidate")?,
        map_version: row.try_get("map_version")?,
        decision: row.try_get("verdict")?,
        reason: row.try_get("reason")?,
        why: row.try_get("why")?,
    })
}
