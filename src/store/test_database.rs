//! Empty databases for tests.

use std::hash::{Hash as _, Hasher as _};
use std::path::Path;

use sqlx::sqlite::{SqliteConnectOptions, SqliteJournalMode, SqlitePoolOptions, SqliteSynchronous};
use sqlx::{Connection as _, PgConnection};

use super::files::schema;
use super::sql::Pool;
use crate::domain::verdict::Decision;
use crate::domain::verdict_line::VerdictLine;

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

/// Returns the address of the database that belongs to a folder: a file in it or, where `REVISIT_TEST_ENGINE` is `postgres`, a database
/// of the server that `REVISIT_TEST_POSTGRES` names, which is made if it is not there.
pub(crate) async fn address_in(folder: &Path) -> String {
    if std::env::var("REVISIT_TEST_ENGINE").as_deref() != Ok("postgres") {
        return format!("sqlite://{}/test.db", folder.display());
    }
    postgres_in(folder).await
}

/// Returns the address of the database that belongs to a folder, of the server that `REVISIT_TEST_POSTGRES` names; it is made if it is
/// not there.
pub(crate) async fn postgres_in(folder: &Path) -> String {
    let server = std::env::var("REVISIT_TEST_POSTGRES").expect("REVISIT_TEST_POSTGRES names a server");
    let mut hasher = std::hash::DefaultHasher::new();
    folder.hash(&mut hasher);
    let name = format!("law_{}_{:x}", std::process::id(), hasher.finish());
    let mut db = PgConnection::connect(&format!("{server}/postgres")).await.expect("a PostgreSQL server");
    let select = "select count(*) from pg_database where datname = $1";
    let found: i64 = sqlx::query_scalar(select).bind(&name).fetch_one(&mut db).await.expect("its databases");
    if found == 0 {
        let create = sqlx::AssertSqlSafe(format!("create database {name}"));
        sqlx::query(create).execute(&mut db).await.expect("a database");
    }
    format!("{server}/{name}")
}
