//! Blocks of rows as they are, on their way from a map to a copy of it.

use sqlx::sqlite::SqliteRow;
use sqlx::{Column as _, Row as _, TypeInfo as _, ValueRef as _};

use crate::store::StoreError;

/// Bytes of a block, about; one row may have more. It is a transaction's work of some 10 ms.
const BLOCK_BYTES: usize = 1 << 20;

/// Most rows of a block.
const BLOCK_ROWS: usize = 512;

/// A value of a row.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// None.
    Null,
    /// A whole number.
    Integer(i64),
    /// A number.
    Real(f64),
    /// A text.
    Text(String),
    /// Bytes.
    Blob(Vec<u8>),
}

/// Some rows of one table, without the map's key.
#[derive(Debug)]
pub struct RowBlock {
    pub(in crate::store) table: &'static str,
    pub(in crate::store) columns: Vec<String>,
    pub(in crate::store) rows: Vec<Vec<Cell>>,
    /// Their bytes, about.
    pub bytes: usize,
}

impl RowBlock {
    pub(in crate::store) fn of(table: &'static str) -> Self {
        Self { table, columns: Vec::new(), rows: Vec::new(), bytes: 0 }
    }

    pub(in crate::store) fn add(&mut self, row: &SqliteRow) -> Result<(), StoreError> {
        let (columns, cells) = cells(row)?;
        self.bytes += cells.iter().map(Cell::bytes).sum::<usize>();
        self.columns = columns;
        self.rows.push(cells);
        Ok(())
    }

    pub(in crate::store) fn is_full(&self) -> bool {
        self.bytes >= BLOCK_BYTES || self.rows.len() >= BLOCK_ROWS
    }

    /// Returns the number of its rows.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// Whether it has none.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }
}

impl Cell {
    fn bytes(&self) -> usize {
        size_of::<Self>()
            + match self {
                Self::Text(text) => text.len(),
                Self::Blob(bytes) => bytes.len(),
                _ => 0,
            }
    }
}

/// Returns the columns of a row and its values, without the map's key.
fn cells(row: &SqliteRow) -> Result<(Vec<String>, Vec<Cell>), StoreError> {
    let mut columns = Vec::with_capacity(row.columns().len());
    let mut cells = Vec::with_capacity(row.columns().len());
    for (place, column) in row.columns().iter().enumerate() {
        if column.name() == "map_key" {
            continue;
        }
        let value = row.try_get_raw(place)?;
        let cell = if value.is_null() {
            Cell::Null
        } else {
            match value.type_info().name() {
                "INTEGER" | "BOOLEAN" => Cell::Integer(row.try_get_unchecked(place)?),
                "REAL" => Cell::Real(row.try_get_unchecked(place)?),
                "TEXT" => Cell::Text(row.try_get_unchecked(place)?),
                "BLOB" => Cell::Blob(row.try_get_unchecked(place)?),
                other => return Err(StoreError::Database(format!("a column of type {other}"))),
            }
        };
        columns.push(column.name().to_owned());
        cells.push(cell);
    }
    Ok((columns, cells))
}
