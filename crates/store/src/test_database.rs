//! Empty databases for tests.

use revisit_core::domain::verdict::Decision;
use revisit_core::domain::verdict_line::VerdictLine;
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

/// Returns a line of a verdict.
pub(super) fn a_line() -> VerdictLine {
    let (keyframe, candidate, reason) = (None, None, None);
    VerdictLine {
        keyframe,
        candidate,
        map_version: 1,
        decision: Decision::NoLoop,
        reason,
        why: String::new(),
    }
}
