//! Twins as rows, to the database and back.

use super::statement::{Query, run};
use crate::domain::change::{Change, Twins};
use crate::domain::ids::{AnchorSeq, KeyframeSeq};
use crate::store::StoreError;
use crate::store::commit::job::MapKey;
use crate::store::sql::{self, Connection};

fn bound(query: Query, map: MapKey, twins: &Twins) -> Query {
    let Twins { keyframe, candidate, anchor, candidate_anchor } = twins;
    query.bind(map).bind(keyframe.0).bind(candidate.0).bind(anchor.0).bind(candidate_anchor.0)
}

/// Adds a pair.
pub(in crate::store) async fn add(db: &mut Connection, map: MapKey, twins: &Twins) -> Result<(), StoreError> {
    let insert = "insert into twins (map_key, keyframe, candidate, anchor, candidate_anchor)
        values ($1, $2, $3, $4, $5) on conflict do nothing";
    run(db, bound(sql::query(insert), map, twins)).await
}

/// Removes a pair.
pub(in crate::store) async fn remove(
    db: &mut Connection,
    map: MapKey,
    twins: &Twins,
) -> Result<(), StoreError> {
    let delete = "delete from twins where map_key = $1 and keyframe = $2 and candidate = $3
        and anchor = $4 and candidate_anchor = $5";
    run(db, bound(sql::query(delete), map, twins)).await
}

/// Returns the pairs of a map.
pub(in crate::store) async fn all(db: &mut Connection, map: MapKey) -> Result<Vec<Change>, StoreError> {
    let select = "select keyframe, candidate, anchor, candidate_anchor from twins where map_key = $1";
    let rows: Vec<(u32, u32, u32, u32)> = sql::query_as(select).bind(map).fetch_all(db).await?;
    let found = |(keyframe, candidate, anchor, other)| {
        let (keyframe, candidate) = (KeyframeSeq(keyframe), KeyframeSeq(candidate));
        let (anchor, candidate_anchor) = (AnchorSeq(anchor), AnchorSeq(other));
        Change::TwinsFound(Twins { keyframe, candidate, anchor, candidate_anchor })
    };
    Ok(rows.into_iter().map(found).collect())
}
