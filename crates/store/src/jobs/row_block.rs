//! Blocks of rows as they are, on their way from a map to a copy of it.

use crate::StoreError;
use crate::sql::Row;
use crate::sql::cell::Cell;

/// Bytes of a block, about; one row may have more. It is a transaction's work of some 10 ms.
const BLOCK_BYTES: usize = 1 << 20;

/// Most rows of a block.
const BLOCK_ROWS: usize = 512;

/// Some rows of one table, without a column that the other place fills in: the map's key, where it has one.
#[derive(Debug)]
pub struct RowBlock {
    pub(crate) table: &'static str,
    pub(crate) columns: Vec<String>,
    filled_in: &'static str,
    pub(crate) rows: Vec<Vec<Cell>>,
    /// Their bytes, about.
    pub bytes: usize,
}

impl RowBlock {
    pub(crate) fn of(table: &'static str) -> Self {
        Self::without(table, "")
    }

    /// Returns no rows yet of a table, without this column.
    pub(crate) fn without(table: &'static str, filled_in: &'static str) -> Self {
        Self { table, columns: Vec::new(), filled_in, rows: Vec::new(), bytes: 0 }
    }

    /// Returns rows of the same columns instead of its own.
    pub(crate) fn with(&self, rows: Vec<Vec<Cell>>) -> Self {
        Self { columns: self.columns.clone(), rows, ..*self }
    }

    /// Takes columns out.
    pub(crate) fn leave_out(&mut self, columns: &[&str]) {
        let stays: Vec<bool> =
            self.columns.iter().map(|column| !columns.contains(&column.as_str())).collect();
        let mut of_columns = stays.iter();
        self.columns.retain(|_| of_columns.next() == Some(&true));
        for row in &mut self.rows {
            let mut of_row = stays.iter();
            row.retain(|_| of_row.next() == Some(&true));
        }
    }

    pub(crate) fn add(&mut self, row: &Row) -> Result<(), StoreError> {
        let (columns, cells) = row.cells()?;
        let is_other = |column: &str| column == "map_key" || column == self.filled_in;
        let of_map = |(column, cell): (String, Cell)| (!is_other(&column)).then_some((column, cell));
        let (columns, cells): (Vec<String>, Vec<Cell>) =
            columns.into_iter().zip(cells).filter_map(of_map).unzip();
        self.bytes += cells.iter().map(Cell::bytes).sum::<usize>();
        self.columns = columns;
        self.rows.push(cells);
        Ok(())
    }

    pub(crate) fn is_full(&self) -> bool {
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
