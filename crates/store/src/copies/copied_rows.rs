//! Rows of a map on their way to a copy of it, as they are: no index is built for that.

use futures_util::TryStreamExt as _;
use sqlx::AssertSqlSafe;

use crate::StoreError;
use crate::columns::bulk_insert::{RowValues, write_rows};
use crate::jobs::row_block::RowBlock;
use crate::map_key::MapKey;
use crate::rows::map_tables::{TABLES, Table};
use crate::sql::cell::Cell;
use crate::sql::run;
use crate::sql::{self, Connection};

/// Tables that a copy begins without: what happened to the map and who asked it.
const NOT_COPIED: [&str; 5] = ["events", "loop_queries", "judgements", "release_uses", "erasures"];

/// The tables of a map that are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Which {
    /// Those that a copy of the map has.
    OfCopy,
    /// Every one: the map goes into another database.
    Every,
}

/// Reads the row of a map, without its key.
pub(crate) async fn map_row(db: &mut Connection, map: MapKey) -> Result<RowBlock, StoreError> {
    let mut block = RowBlock::of("maps");
    let row = sql::query("select * from maps where map_key = $1").bind(map).fetch_one(db).await?;
    block.add(&row)?;
    Ok(block)
}

/// Reads all rows of a map in some tables, parents before children, and gives them away in blocks.
pub(crate) async fn read_blocks<F: Future<Output = Result<(), StoreError>>>(
    db: &mut Connection,
    map: MapKey,
    which: Which,
    mut take: impl FnMut(RowBlock) -> F,
) -> Result<(), StoreError> {
    let is_read = |table: &&Table| which == Which::Every || !NOT_COPIED.contains(&table.name);
    let tables = TABLES.iter().rev().filter(is_read).map(|table| {
        let Table { name, key, .. } = table;
        (*name, *key, only_committed(name))
    });
    for (table, key, condition) in tables {
        let select = format!("select * from {table} where map_key = $1 {condition} order by {key}");
        let mut rows = sql::query(AssertSqlSafe(select)).bind(map).fetch(&mut *db);
        let mut block = RowBlock::of(table);
        while let Some(row) = rows.try_next().await? {
            block.add(&row)?;
            if block.is_full() {
                take(std::mem::replace(&mut block, RowBlock::of(table))).await?;
            }
        }
        if !block.is_empty() {
            take(block).await?;
        }
    }
    Ok(())
}

/// Leaves out the parts of a correction that is not committed yet: no version is made of them.
fn only_committed(table: &str) -> &'static str {
    if table == "versions" {
        "and exists (select 1 from versions o
            where o.map_key = versions.map_key and o.version = versions.version and (o.part = 0 or versions.part < 0))"
    } else {
        ""
    }
}

/// Adds the row of a map that is a copy of another one, under an id by which no client finds it, and not complete yet.
pub(crate) async fn begin(db: &mut Connection, row: &RowBlock, id: &str) -> Result<(), StoreError> {
    let give = "update counters set last = last + 1 where name = 'map' returning last";
    let key: MapKey = sql::query_scalar(give).fetch_one(&mut *db).await?;
    let replaced = |column: &str| match column {
        "id" => Some(Cell::Text(id.to_owned())),
        "deleted" => Some(Cell::Integer(2)),
        _ => None,
    };
    let of_copy = |cells: &Vec<Cell>| {
        let cell = |(column, cell): (&String, &Cell)| replaced(column).unwrap_or_else(|| cell.clone());
        row.columns.iter().zip(cells).map(cell).collect()
    };
    let rows = row.rows.iter().map(of_copy).collect();
    write_block(db, key, &row.with(rows)).await
}

/// Writes rows to a copy.
pub(crate) async fn write_block(
    db: &mut Connection,
    map: MapKey,
    block: &RowBlock,
) -> Result<(), StoreError> {
    let head = format!("insert into {} (map_key, {}) ", block.table, block.columns.join(", "));
    write_rows(db, &head, "", &block.rows, |row, cells| {
        row.push_bind(map);
        for cell in cells {
            push_cell(row, cell);
        }
    })
    .await
}

/// Adds a value as it is.
pub(crate) fn push_cell(row: &mut RowValues, cell: &Cell) {
    match cell {
        Cell::Null => row.push_null(),
        Cell::Integer(number) => row.push_bind(*number),
        Cell::Real(number) => row.push_bind(*number),
        Cell::Text(text) => row.push_bind(text),
        Cell::Blob(bytes) => row.push_bind(bytes),
    };
}

/// Deletes the copies that an earlier process did not complete.
pub(crate) async fn remove_incomplete(db: &mut Connection) -> Result<(), StoreError> {
    run(db, sql::query("update maps set deleted = 1, id = 'deleted//' || map_key where deleted = 2")).await
}
