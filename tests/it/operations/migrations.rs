//! Migrations: a new database is made whole or not at all, and one that another program made is refused.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use revisit::store::Store;
use serde_json::{Value, json};
use sqlx::sqlite::SqliteConnectOptions;
use sqlx::{ConnectOptions as _, Connection as _, Executor as _, PgConnection};

use super::{revisit, sound, url};
use crate::crash::server::Server;
use crate::support::postgres_of;

/// What SQLite writes before the pages of its log, and before each page.
const LOG_HEADER_BYTES: usize = 32;
const FRAME_BYTES: usize = 24 + 16384;

const UNKNOWN_FORM: &str = "export its maps with that build, and replay them into a new database";

type Schema = BTreeMap<String, Option<String>>;

/// Opens a database with its log as a start after a crash would.
async fn schema_of(database: &Path) -> Schema {
    let mut db = SqliteConnectOptions::new().filename(database).connect().await.unwrap();
    let select =
        "select name, sql from sqlite_schema where name not like 'sqlite%' and name not like '_sqlx%'";
    let rows: Vec<(String, Option<String>)> = sqlx::query_as(select).fetch_all(&mut db).await.unwrap();
    db.close().await.unwrap();
    rows.into_iter().collect()
}

#[tokio::test(flavor = "multi_thread")]
async fn a_crash_in_the_middle_of_the_first_start_leaves_all_tables_or_none() {
    let folder = tempfile::tempdir().unwrap();
    let database = folder.path().join("test.db");
    let store = Store::open(&url(&database)).await.unwrap();
    // As on a disk whose power goes: the tables are in the log, in the order in which they were written.
    let bytes = std::fs::read(&database).unwrap();
    let log = std::fs::read(folder.path().join("test.db-wal")).unwrap();
    store.close().await;
    let whole = schema_of(&database).await;
    let frames = (log.len() - LOG_HEADER_BYTES) / FRAME_BYTES;
    assert!(frames > whole.len(), "{frames} pages are no migration");
    let (crashed, mut seen) = (folder.path().join("crashed.db"), BTreeSet::new());
    for frame in 0..=frames {
        for torn in [0, 1, FRAME_BYTES / 2] {
            let written = (LOG_HEADER_BYTES + frame * FRAME_BYTES + torn).min(log.len());
            std::fs::write(&crashed, &bytes).unwrap();
            std::fs::write(folder.path().join("crashed.db-wal"), &log[..written]).unwrap();
            let schema = schema_of(&crashed).await;
            assert!(schema.is_empty() || schema == whole, "{written} bytes of the log: a part of the tables");
            seen.insert(schema.len());
        }
        Store::open(&url(&crashed)).await.unwrap().close().await;
        sound(&crashed).await;
    }
    assert_eq!(seen, BTreeSet::from([0, whole.len()]));
}

#[tokio::test(flavor = "multi_thread")]
async fn the_first_start_logs_no_warning() {
    let folder = tempfile::tempdir().unwrap();
    let database = folder.path().join("new.db");
    let mut server = Server::start_with(&database, &["--log-format", "json"]);
    assert_eq!(server.api().put("/v1/maps/m", &json!({})).await.status, 201);
    assert!(server.terminate().success());
    let log = std::fs::read_to_string(database.with_extension("log")).unwrap();
    let lines: Vec<Value> = log.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert!(!lines.is_empty() && lines.iter().all(|line| line["level"] == "INFO"), "{log}");
    assert!(!log.contains("schema"), "{log}");
}

/// Changes a database by a statement, and closes it.
async fn change(database: &Path, sql: &'static str) {
    let options = SqliteConnectOptions::new().filename(database).create_if_missing(true);
    let mut db = options.connect().await.unwrap();
    db.execute(sql).await.unwrap();
    db.close().await.unwrap();
}

/// Every command that opens a database refuses this one.
fn is_refused(database: &Path, because: &str) {
    let from = url(database);
    let [restored, recording] = ["restored.db", "m.ndjson"].map(|name| database.with_file_name(name));
    for arguments in [
        vec!["serve", "--listen", "127.0.0.1:0", "--database", &from],
        vec!["export", "m", &recording.display().to_string(), "--database", &from],
        vec!["restore", "--database", &url(&restored), &database.display().to_string()],
    ] {
        revisit(&arguments).refused(because);
    }
    let checked = revisit(&["check", "--database", &from]);
    assert!(!checked.succeeded && (checked.out + &checked.err).contains(because));
}

#[tokio::test(flavor = "multi_thread")]
async fn a_database_of_a_newer_version_is_refused_and_left_alone() {
    let folder = tempfile::tempdir().unwrap();
    let (database, backup) = (folder.path().join("newer.db"), folder.path().join("backup.db"));
    Store::open(&url(&database)).await.unwrap().close().await;
    let insert = "insert into _sqlx_migrations (version, description, success, checksum, execution_time)
        values (9999, 'from the future', 1, x'00', 1)";
    change(&database, insert).await;
    let before = std::fs::read(&database).unwrap();
    is_refused(&database, "the database has schema 9999, and this version of revisit knows");
    // A copy does not have to understand what it copies.
    revisit(&["backup", "--database", &url(&database), &backup.display().to_string()]).well();
    assert!(before == std::fs::read(&database).unwrap());
}

#[tokio::test(flavor = "multi_thread")]
async fn a_database_that_no_version_made_is_refused_and_the_sentence_says_what_to_do() {
    let folder = tempfile::tempdir().unwrap();
    let [edited, other] = ["edited.db", "other.db"].map(|name| folder.path().join(name));
    Store::open(&url(&edited)).await.unwrap().close().await;
    change(&edited, "update _sqlx_migrations set checksum = x'00'").await;
    let before = std::fs::read(&edited).unwrap();
    is_refused(&edited, UNKNOWN_FORM);
    assert!(before == std::fs::read(&edited).unwrap());
    change(&other, "create table readings (a integer)").await;
    is_refused(&other, UNKNOWN_FORM);
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs REVISIT_TEST_POSTGRES"]
async fn a_postgres_database_that_no_version_made_is_refused_in_the_same_words() {
    for damage in ["update _sqlx_migrations set checksum = '\\x00'", "drop table _sqlx_migrations"] {
        let folder = tempfile::tempdir().unwrap();
        let database = postgres_of(folder.path()).await;
        Store::open(&database).await.unwrap().close().await;
        let mut db = PgConnection::connect(&database).await.unwrap();
        db.execute(damage).await.unwrap();
        db.close().await.unwrap();
        revisit(&["serve", "--listen", "127.0.0.1:0", "--database", &database]).refused(UNKNOWN_FORM);
    }
}
