//! Renewal: the database's file and its log without the bytes of what was deleted.
//!
//! SQLite leaves deleted rows where they were until their pages are used again, and moves rows between pages without wiping them.
//! So the file is written anew as a whole (`VACUUM`), which goes through the log; then the log is brought into the file and cut.

use sqlx::sqlite::SqlitePool;

use super::queue::Renewal;
use crate::StoreError;
use crate::files::paths::BUSY_TIMEOUT;

/// Makes the file or the log anew, on the one connection that writes.
pub(crate) async fn renew(writer: &SqlitePool, renewal: Renewal) -> Result<(), StoreError> {
    match renewal {
        Renewal::File => {
            sqlx::query("vacuum").execute(writer).await?;
            Ok(())
        }
        Renewal::Log => {
            let mut db = writer.acquire().await?;
            // Whoever reads an older version is not waited for here, where jobs wait.
            sqlx::query("pragma busy_timeout = 0").execute(&mut *db).await?;
            let cut: Result<(i64, i64, i64), _> =
                sqlx::query_as("pragma wal_checkpoint(truncate)").fetch_one(&mut *db).await;
            let restore = sqlx::AssertSqlSafe(format!("pragma busy_timeout = {}", BUSY_TIMEOUT.as_millis()));
            sqlx::query(restore).execute(&mut *db).await?;
            match cut? {
                (0, ..) => Ok(()),
                _ => Err(StoreError::Busy),
            }
        }
    }
}
