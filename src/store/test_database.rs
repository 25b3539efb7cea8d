//! An empty database for tests.

use sqlx::sqlite::{SqliteConnectOptions, SqliteJournalMode, SqlitePoolOptions, SqliteSynchronous};

use super::files::schema;
use super::sql::Pool;

/// Returns an empty database with this version's schema, and the folder that it lies in.
pub(super) async fn database() -> (tempfile::TempDir, Pool) {
    let folder = tempfile::tempdir().expect("a folder");
    let options = SqliteConnectOptions::new().filename(folder.path().join("test.db"));
    let options = options.create_if_missing(true).journal_mode(SqliteJournalMode::Wal);
    // A test that loses its machine has other worries.
    let options = options.synchronous(SqliteSynchronous::Off);
    let pool = SqlitePoolOptions::new().max_connections(1).connect_with(options).await.expect("a pool");
    schema::migrate(&pool).await.expect("a schema");
    (folder, pool.into())
}
