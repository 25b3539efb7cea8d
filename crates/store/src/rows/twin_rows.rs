//! Twins as rows, to the database and back.

use revisit_core::domain::change::{Change, Twins};

use crate::StoreError;
use crate::map_key::MapKey;
use crate::sql::{self, Connection, Query};

/// Adds a pair.
pub(crate) fn add(map: MapKey, twins: &Twins) -> Query {
    let insert = "insert into twins (map_key, keyframe, candidate, anchor, candidate_anchor)
        values ($1, $2, $3, $4, $5) on conflict do nothing";
    statement(insert, map, twins)
}

/// Removes a pair.
pub(crate) fn remove(map: MapKey, twins: &Twins) -> Query {
    let delete = "delete from twins where map_key = $1 and keyframe = $2 and candidate = $3
        and anchor = $4 and candidate_anchor = $5";
    statement(delete, map, twins)
}

fn statement(sql: &'static str, map: MapKey, twins: &Twins) -> Query {
    let Twins { keyframe, candidate, anchor, candidate_anchor } = *twins;
    sql::statement(sql, (map, keyframe, candidate, anchor, candidate_anchor))
}

/// Returns the pairs of a map.
pub(crate) async fn all(db: &mut Connection, map: MapKey) -> Result<Vec<Change>, StoreError> {
    let select = "select keyframe, candidate, anchor, candidate_anchor from twins where map_key = $1";
    let rows: Vec<(_, _, _, _)> = sql::query_as(select).bind(map).fetch_all(db).await?;
    let found = |(keyframe, candidate, anchor, candidate_anchor)| {
        Change::TwinsFound(Twins { keyframe, candidate, anchor, candidate_anchor })
    };
    Ok(rows.into_iter().map(found).collect())
}
