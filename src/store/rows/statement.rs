//! Statements that return no rows.

use crate::store::StoreError;
use crate::store::sql::Connection;
pub(in crate::store) use crate::store::sql::query::Query;

/// Executes a statement.
pub(in crate::store) async fn run(db: &mut Connection, query: Query) -> Result<(), StoreError> {
    query.execute(db).await?;
    Ok(())
}
