//! Rows: statements with many rows.

use std::fmt::Write as _;

use sqlx::AssertSqlSafe;

use crate::StoreError;
use crate::sql::value::{ToValue, Value};
use crate::sql::{Connection, Engine, query};

/// Rows of a statement. A connection keeps a statement for each number of rows, so there are few numbers.
const SIZES: [usize; 3] = [32, 8, 1];

/// The same for PostgreSQL, where each statement is a round trip: 20 rows take two.
const SIZES_POSTGRES: [usize; 9] = [256, 128, 64, 32, 16, 8, 4, 2, 1];

/// Most parameters of a statement of PostgreSQL.
const PARAMETERS_MAX: usize = 65_535;

/// The values of one row after the other, and the text of the statement they go into.
#[derive(Debug, Default)]
pub(crate) struct RowValues {
    sql: String,
    values: Vec<Value>,
    /// Whether the next value is the first of its row.
    is_first: bool,
}

impl RowValues {
    /// Adds the next value of the row.
    pub(crate) fn push_bind(&mut self, value: impl ToValue) -> &mut Self {
        self.values.push(value.to_value());
        let number = self.values.len();
        self.separate();
        // Writing to a string never fails.
        let _ = write!(self.sql, "${number}");
        self
    }

    /// Adds a null of no type, which both engines take for that of its column.
    pub(crate) fn push_null(&mut self) -> &mut Self {
        self.separate();
        self.sql.push_str("null");
        self
    }

    fn separate(&mut self) {
        if !std::mem::take(&mut self.is_first) {
            self.sql.push_str(", ");
        }
    }
}

/// Writes rows with statements `head values (...), (...) tail`. In brackets the values are a table with the columns `column1`
/// and so on.
pub(crate) async fn write_rows<T>(
    db: &mut Connection,
    head: &str,
    tail: &str,
    rows: &[T],
    push: impl Fn(&mut RowValues, &T),
) -> Result<(), StoreError> {
    let sizes = match db.engine() {
        Engine::Sqlite => &SIZES[..],
        Engine::Postgres => &SIZES_POSTGRES,
    };
    let mut left = rows;
    for size in sizes {
        while left.len() >= *size {
            let (chunk, rest) = left.split_at(*size);
            let Some(statement) = statement(head, tail, chunk, &push) else { break };
            query(AssertSqlSafe(statement.sql)).bind_all(statement.values).execute(&mut *db).await?;
            left = rest;
        }
    }
    Ok(())
}

/// Returns the statement of some rows; `None` where it would have too many parameters.
fn statement<T>(head: &str, tail: &str, rows: &[T], push: impl Fn(&mut RowValues, &T)) -> Option<RowValues> {
    let mut statement = RowValues { sql: format!("{head}values "), ..RowValues::default() };
    for (number, row) in rows.iter().enumerate() {
        statement.sql.push_str(if number == 0 { "(" } else { "), (" });
        statement.is_first = true;
        push(&mut statement, row);
        if number == 0 && statement.values.len() * rows.len() > PARAMETERS_MAX {
            return None;
        }
    }
    statement.sql.push(')');
    statement.sql.push_str(tail);
    Some(statement)
}
