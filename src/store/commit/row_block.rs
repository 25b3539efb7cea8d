//! Blocks of rows as they are, on their way from a map to a copy of it.

use crate::store::StoreError;
use crate::store::sql::Row;
use crate::store::sql::cell::Cell;

/// Bytes of a block, about; one row may have more. It is a transaction's work of some 10 ms.
const BLOCK_BYTES: usize = 1 << 20;

/// Most rows of a block.
const BLOCK_ROWS: usize = 512;

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

    pub(in crate::store) fn add(&mut self, row: &Row) -> Result<(), StoreError> {
        let (columns, cells) = row.cells()?;
        let of_map = |(column, cell): (String, Cell)| (column != "map_key").then_some((column, cell));
        let (columns, cells): (Vec<String>, Vec<Cell>) =
            columns.into_iter().zip(cells).filter_map(of_map).unzip();
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
