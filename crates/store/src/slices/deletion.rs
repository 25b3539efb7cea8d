//! Deletion of a map: it is marked in one small transaction, and its rows are removed in slices.
//!
//! From the mark on the map is deleted: its name is free, and every read of `maps` passes it over. Its rows stay until
//! slices have removed them, children before parents, so that no statement cascades over a million rows. A process
//! that dies on the way leaves a marked map, and the next one continues.

use sqlx::AssertSqlSafe;

use crate::StoreError;
use crate::map_key::MapKey;
use crate::rows::map_tables::{TABLES, Table};
use crate::sql::run;
use crate::sql::{self, Connection, Engine};

/// Bytes of blobs that one step removes; a single row may have more. Their pages are read one by one.
const STEP_BLOB_BYTES: i64 = 4 << 20;

/// Returns the statement that removes the next rows of a map.
fn delete_from(table: &Table, engine: Engine) -> String {
    let Table { name, key, .. } = table;
    let has_rowid = table.has_rowid && engine == Engine::Sqlite;
    let of_map = if has_rowid { "rowid".to_owned() } else { format!("map_key, {key}") };
    format!(
        "delete from {name} where ({of_map}) in
            (select {of_map} from {name} where map_key = $1 order by {key} limit $2)"
    )
}

/// Deletes a map and its releases: frees their names and leaves their rows to the slices.
pub(crate) async fn mark_deleted(db: &mut Connection, map: MapKey) -> Result<(), StoreError> {
    // No client can give an id with two slashes, nor name a map and a release so.
    let update = "update maps set deleted = 1, id = 'deleted//' || map_key
        where map_key = $1 or map_key in (select release_key from releases where map_key = $1)";
    run(db, sql::query(update).bind(map)).await?;
    let delete = "delete from releases where map_key = $1 or release_key = $1";
    run(db, sql::query(delete).bind(map)).await
}

/// Removes about this many rows of a deleted map, in the caller's transaction. Returns whether there may be more.
pub(crate) async fn remove_rows(db: &mut Connection, rows: u32) -> Result<bool, StoreError> {
    let select = match db.engine() {
        Engine::Sqlite => "select map_key from maps where deleted = 1 order by map_key limit 1",
        // Another server may be at one of them.
        Engine::Postgres => {
            "select map_key from maps where deleted = 1 order by map_key limit 1 for update skip locked"
        }
    };
    let Some(map) = sql::query_scalar::<MapKey>(select).fetch_optional(&mut *db).await? else {
        return Ok(false);
    };
    let mut left = i64::from(rows);
    for table in TABLES {
        left -= remove_rows_of(db, map, table, left).await?;
        if left <= 0 {
            return Ok(true);
        }
    }
    run(db, sql::query("delete from maps where map_key = $1").bind(map)).await?;
    Ok(true)
}

/// Removes rows of one table. Returns how many, or all that were left where their blobs used up the step.
async fn remove_rows_of(
    db: &mut Connection,
    map: MapKey,
    table: &Table,
    left: i64,
) -> Result<i64, StoreError> {
    let within = match table.blobs {
        Some(blobs) => rows_within(db, map, table, blobs, left).await?,
        None => left,
    };
    let delete = sql::query(AssertSqlSafe(delete_from(table, db.engine()))).bind(map).bind(within);
    let removed = delete.execute(&mut *db).await? as i64;
    Ok(if within < left && removed > 0 { left } else { removed })
}

/// Returns the number of the next rows whose blobs fit into a step: at least one.
async fn rows_within(
    db: &mut Connection,
    map: MapKey,
    Table { name, key, .. }: &Table,
    blobs: &str,
    left: i64,
) -> Result<i64, StoreError> {
    // Both engines tell a blob's length without reading it.
    let select = format!("select {blobs} from {name} where map_key = $1 order by {key} limit $2");
    let bytes: Vec<i64> =
        sql::query_scalar(AssertSqlSafe(select)).bind(map).bind(left).fetch_all(&mut *db).await?;
    let mut total = 0;
    let fit = bytes.iter().take_while(|bytes| {
        total += **bytes;
        total <= STEP_BLOB_BYTES
    });
    let fit = fit.count();
    Ok(if fit == bytes.len() { left } else { fit.max(1) as i64 })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_database::database;

    #[tokio::test]
    async fn every_table_with_a_maps_rows_is_removed_in_slices() {
        let (_folder, pool) = database().await;
        let select = "select m.name from sqlite_schema m join pragma_table_info(m.name) c
            where m.type = 'table' and c.name = 'map_key' order by m.name";
        let tables: Vec<String> = sql::query_scalar(select).fetch_all(&pool).await.expect("tables");
        // A map's releases go with it, each a map of its own.
        let small = ["maps", "releases"];
        let missing: Vec<_> = tables
            .iter()
            .filter(|name| {
                !small.contains(&name.as_str()) && !TABLES.iter().any(|table| table.name == **name)
            })
            .collect();
        assert!(
            missing.is_empty(),
            "add {missing:?} to TABLES of store/rows/map_tables.rs, children before parents"
        );
    }

    #[tokio::test]
    async fn slices_find_their_rows_by_a_key_and_never_scan_a_table() {
        let (_folder, pool) = database().await;
        for table in TABLES {
            let plan = AssertSqlSafe(format!("explain query plan {}", delete_from(table, Engine::Sqlite)));
            let steps: Vec<(i64, i64, i64, String)> =
                sql::query_as(plan).bind(1).bind(10).fetch_all(&pool).await.expect("a plan");
            for (.., step) in steps {
                let is_bounded = !step.contains("SCAN") && !step.contains("TEMP B-TREE");
                assert!(is_bounded, "{}: {step}", table.name);
            }
        }
    }
}
