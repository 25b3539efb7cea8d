//! Rows: statements with many rows.

use sqlx::query_builder::Separated;
use sqlx::{QueryBuilder, Sqlite, SqliteConnection};

use crate::store::StoreError;

/// Rows of a statement. A connection keeps a statement for each number of rows, so there are few numbers.
const SIZES: [usize; 3] = [32, 8, 1];

/// A place for the values of a row.
pub(in crate::store) type Row<'q> = Separated<'q, Sqlite, &'static str>;

/// Writes rows with statements `head values (...), (...) tail`. In brackets the values are a table with the columns `column1`
/// and so on.
pub(in crate::store) async fn write_rows<T>(
    db: &mut SqliteConnection,
    head: &'static str,
    tail: &'static str,
    rows: &[T],
    push: impl Fn(&mut Row<'_>, &T),
) -> Result<(), StoreError> {
    let mut left = rows;
    for size in SIZES {
        while left.len() >= size {
            let (chunk, rest) = left.split_at(size);
            let mut query = QueryBuilder::<Sqlite>::new(head);
            query.push_values(chunk, |mut row, values| push(&mut row, values));
            query.push(tail).build().execute(&mut *db).await?;
            left = rest;
        }
    }
    Ok(())
}
