//! Statements that return no rows.

use sqlx::{Sqlite, SqliteConnection};

use crate::store::StoreError;

/// A statement with its values.
pub(in crate::store) type Query<'q> = sqlx::query::Query<'q, Sqlite, sqlx::sqlite::SqliteArguments>;

/// Executes a statement.
pub(in crate::store) async fn run(db: &mut SqliteConnection, query: Query<'_>) -> Result<(), StoreError> {
    query.execute(db).await?;
    Ok(())
}
