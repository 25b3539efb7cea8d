//! Rows on their way into another database, of either engine: whole maps, and what stands beside maps.

use std::collections::BTreeMap;

use futures_util::TryStreamExt as _;
use revisit_core::domain::ids::{MapId, StoredId as _};
use sha2::{Digest as _, Sha256};
use sqlx::AssertSqlSafe;

use crate::StoreError;
use crate::columns::bulk_insert::write_rows;
use crate::copies::copied_rows::{Which, map_row, push_cell, read_blocks};
use crate::jobs::row_block::RowBlock;
use crate::map_key::MapKey;
use crate::sql::cell::Cell;
use crate::sql::run;
use crate::sql::{self, Connection};

/// Tables beside those of maps, parents before children, each with its order and the column that the other database fills in.
const BESIDE_MAPS: [(&str, &str, &str); 4] = [
    ("keys", "key", ""),
    ("key_usage", "day, key", ""),
    ("model_usage", "day, operation, model", ""),
    ("model_answers", "kept", "kept"),
];

/// Columns of a map's row that differ between databases though the map is the same.
const OF_THE_DATABASE: [&str; 2] = ["id", "deleted"];

/// A map of a database.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct HeldMap {
    /// Its name; of a release, `map/release`.
    pub id: MapId,
    /// Its key there.
    pub key: MapKey,
    /// Its version.
    pub version: u64,
}

/// Returns the maps that are complete and not deleted, releases among them, by name.
pub(crate) async fn held_maps(db: &mut Connection) -> Result<Vec<HeldMap>, StoreError> {
    let select = "select id, map_key, version from maps where deleted = 0 order by id";
    let rows: Vec<(String, MapKey, i64)> = sql::query_as(select).fetch_all(db).await?;
    let held = |(id, key, version): (String, MapKey, i64)| {
        let id = MapId::stored(&id).map_err(|error| StoreError::corrupt(format!("map {id:?}: {error}")))?;
        Ok(HeldMap { id, key, version: version.unsigned_abs() })
    };
    rows.into_iter().map(held).collect()
}

/// Returns the keys of maps whose copy from another database was not completed.
pub(crate) async fn incomplete(db: &mut Connection) -> Result<Vec<MapKey>, StoreError> {
    Ok(sql::query_scalar("select map_key from maps where deleted = 2 order by map_key").fetch_all(db).await?)
}

/// Reads the rows of the tables beside maps, and gives them away in blocks.
pub(crate) async fn read_beside_maps<F: Future<Output = Result<(), StoreError>>>(
    db: &mut Connection,
    mut take: impl FnMut(RowBlock) -> F,
) -> Result<(), StoreError> {
    for (table, order, filled_in) in BESIDE_MAPS {
        let select = format!("select * from {table} order by {order}");
        let mut rows = sql::query(AssertSqlSafe(select)).fetch(&mut *db);
        let mut block = RowBlock::without(table, filled_in);
        while let Some(row) = rows.try_next().await? {
            block.add(&row)?;
            if block.is_full() {
                take(std::mem::replace(&mut block, RowBlock::without(table, filled_in))).await?;
            }
        }
        if !block.is_empty() {
            take(block).await?;
        }
    }
    Ok(())
}

/// Writes rows of a table beside maps. Those that are there become what they are in the source: a key that was revoked since is.
pub(crate) async fn write_beside_maps(db: &mut Connection, block: &RowBlock) -> Result<(), StoreError> {
    let head = format!("insert into {} ({}) ", block.table, block.columns.join(", "));
    let known = BESIDE_MAPS.iter().find(|(table, ..)| *table == block.table);
    let tail = match known {
        Some((_, key, "")) => {
            let is_key = |column: &String| key.split(", ").any(|of_key| of_key == column);
            let others = block.columns.iter().filter(|column| !is_key(column));
            let set: Vec<String> = others.map(|column| format!("{column} = excluded.{column}")).collect();
            format!(" on conflict ({key}) do update set {}", set.join(", "))
        }
        // Answers are of questions by their digest, and stay the same.
        _ => " on conflict do nothing".to_owned(),
    };
    write_rows(db, &head, &tail, &block.rows, |row, cells| {
        for cell in cells {
            push_cell(row, cell);
        }
    })
    .await
}

/// Reads the rows that say which maps are releases of which, each without the keys of the two, which it names.
pub(crate) async fn read_releases(
    db: &mut Connection,
) -> Result<Vec<(String, String, RowBlock)>, StoreError> {
    let select = "select r.*, m.id as of_id, h.id as held_id from releases r
        join maps m on m.map_key = r.map_key join maps h on h.map_key = r.release_key
        where m.deleted = 0 and h.deleted = 0 order by h.id";
    let mut releases = Vec::new();
    for row in sql::query(select).fetch_all(db).await? {
        let mut block = RowBlock::without("releases", "release_key");
        block.add(&row)?;
        let mut named = |name: &str| -> Result<String, StoreError> {
            let place = block.columns.iter().position(|column| column == name);
            let place = place.ok_or_else(|| StoreError::corrupt("a release without its maps"))?;
            block.columns.remove(place);
            match block.rows[0].remove(place) {
                Cell::Text(id) => Ok(id),
                other => Err(StoreError::corrupt(format!("a map is named {other:?}"))),
            }
        };
        let (of, held) = (named("of_id")?, named("held_id")?);
        releases.push((of, held, block));
    }
    Ok(releases)
}

/// Writes that a map holds a release of another one, unless it is written.
pub(crate) async fn write_release(
    db: &mut Connection,
    (of, held): (MapKey, MapKey),
    block: &RowBlock,
) -> Result<(), StoreError> {
    let head = format!("insert into releases (map_key, release_key, {}) ", block.columns.join(", "));
    write_rows(db, &head, " on conflict do nothing", &block.rows, |row, cells| {
        row.push_bind(of).push_bind(held);
        for cell in cells {
            push_cell(row, cell);
        }
    })
    .await
}

/// Returns the number that the last event had of maps that are deleted; events of new maps are numbered from above it.
pub(crate) async fn last_event(db: &mut Connection) -> Result<i64, StoreError> {
    Ok(sql::query_scalar("select last from counters where name = 'event'").fetch_one(db).await?)
}

/// Numbers events of new maps from above this number.
pub(crate) async fn raise_last_event(db: &mut Connection, last: i64) -> Result<(), StoreError> {
    run(db, sql::query("update counters set last = $1 where name = 'event' and last < $1").bind(last)).await
}

/// Returns a digest of all rows of a map, the same in whatever database they lie, and their number.
pub(crate) async fn digest(db: &mut Connection, map: MapKey) -> Result<([u8; 32], u64), StoreError> {
    let mut rows_by_table: BTreeMap<&'static str, RowsDigest> = BTreeMap::new();
    let mut head = map_row(db, map).await?;
    head.leave_out(&OF_THE_DATABASE);
    rows_by_table.entry("maps").or_default().add(&head);
    read_blocks(db, map, Which::Every, |block| {
        rows_by_table.entry(block.table).or_default().add(&block);
        std::future::ready(Ok(()))
    })
    .await?;
    let mut hash = Sha256::new();
    let mut count = 0;
    for (table, rows) in rows_by_table {
        hash.update(table);
        hash.update(rows.sum);
        hash.update(rows.count.to_le_bytes());
        count += rows.count;
    }
    Ok((hash.finalize().into(), count))
}

/// A digest of a table's rows that does not depend on their order: small tables have none.
#[derive(Debug, Default)]
struct RowsDigest {
    sum: [u8; 32],
    count: u64,
}

impl RowsDigest {
    fn add(&mut self, block: &RowBlock) {
        let mut columns: Vec<(&String, usize)> = block.columns.iter().zip(0..).collect();
        columns.sort();
        for row in &block.rows {
            let mut hash = Sha256::new();
            for (column, place) in &columns {
                hash.update(column);
                hash.update([0]);
                update(&mut hash, &row[*place]);
            }
            // Rows of a table differ, so that none takes another one away.
            for (of_all, of_row) in self.sum.iter_mut().zip(hash.finalize()) {
                *of_all ^= of_row;
            }
            self.count += 1;
        }
    }
}

fn update(hash: &mut Sha256, cell: &Cell) {
    let (kind, bytes): (u8, &[u8]) = match cell {
        Cell::Null => (0, &[]),
        Cell::Integer(number) => (1, &number.to_le_bytes()),
        Cell::Real(number) => (2, &number.to_bits().to_le_bytes()),
        Cell::Text(text) => (3, text.as_bytes()),
        Cell::Blob(bytes) => (4, bytes),
    };
    hash.update([kind]);
    hash.update((bytes.len() as u64).to_le_bytes());
    hash.update(bytes);
}
