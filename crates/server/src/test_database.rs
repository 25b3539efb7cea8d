//! Databases for tests, on either engine.

use std::hash::{Hash as _, Hasher as _};
use std::path::Path;

use sqlx::{Connection as _, PgConnection};

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
