//! Migrations: wherever the process dies, the schema is one that some version had; and nobody goes back.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use revisit::store::Store;
use sqlx::sqlite::SqliteConnectOptions;
use sqlx::{AssertSqlSafe, ConnectOptions as _, Connection as _, Executor as _, SqliteConnection};

use super::{fixtures, revisit, sound, url};

const MIGRATIONS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/migrations/sqlite");
/// What SQLite writes before the pages of its log, and before each page.
const LOG_HEADER_BYTES: usize = 32;
const FRAME_BYTES: usize = 24 + 16384;

type Schema = BTreeMap<String, Option<String>>;

async fn schema_of(db: &mut SqliteConnection) -> Schema {
    let select =
        "select name, sql from sqlite_schema where name not like 'sqlite%' and name not like '_sqlx%'";
    sqlx::query_as::<_, (String, Option<String>)>(select).fetch_all(db).await.unwrap().into_iter().collect()
}

/// The schema after each migration, by the number of its file.
async fn schemas() -> BTreeMap<usize, Schema> {
    let mut files: Vec<_> =
        std::fs::read_dir(MIGRATIONS).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    let mut db = SqliteConnectOptions::new().in_memory(true).connect().await.unwrap();
    let mut schemas = BTreeMap::from([(0, Schema::new())]);
    for file in files {
        let name = file.file_name().unwrap().to_string_lossy().into_owned();
        db.execute(AssertSqlSafe(std::fs::read_to_string(file).unwrap())).await.unwrap();
        schemas.insert(name[..4].parse().unwrap(), schema_of(&mut db).await);
    }
    schemas
}

/// Opens a database with its log as a start after a crash would.
async fn version_and_schema(database: &Path) -> (usize, Schema) {
    let mut db = SqliteConnectOptions::new().filename(database).connect().await.unwrap();
    let version: i64 =
        sqlx::query_scalar("select max(version) from _sqlx_migrations").fetch_one(&mut db).await.unwrap();
    let schema = schema_of(&mut db).await;
    db.close().await.unwrap();
    (version as usize, schema)
}

#[tokio::test(flavor = "multi_thread")]
async fn a_crash_in_the_middle_of_a_migration_leaves_the_schema_before_or_after_it() {
    let schemas = schemas().await;
    let newest = *schemas.keys().next_back().unwrap();
    let folder = tempfile::tempdir().unwrap();
    let database = folder.path().join("test.db");
    std::fs::write(&database, &fixtures::databases()["0001_facts"]).unwrap();
    let store = Store::open(&url(&database)).await.unwrap();
    // As on a disk whose power goes: the migrations are in the log, in the order in which they were written.
    let bytes = std::fs::read(&database).unwrap();
    let log = std::fs::read(folder.path().join("test.db-wal")).unwrap();
    store.close().await;
    let frames = (log.len() - LOG_HEADER_BYTES) / FRAME_BYTES;
    assert!(frames > schemas.len(), "{frames} pages are no migration");
    let (crashed, mut seen) = (folder.path().join("crashed.db"), BTreeSet::new());
    for frame in 0..=frames {
        for torn in [0, 1, FRAME_BYTES / 2] {
            let written = (LOG_HEADER_BYTES + frame * FRAME_BYTES + torn).min(log.len());
            std::fs::write(&crashed, &bytes).unwrap();
            std::fs::write(folder.path().join("crashed.db-wal"), &log[..written]).unwrap();
            let (version, schema) = version_and_schema(&crashed).await;
            assert_eq!(
                schema, schemas[&version],
                "{written} bytes of the log: not the schema of version {version}"
            );
            seen.insert(version);
        }
        Store::open(&url(&crashed)).await.unwrap().close().await;
        let after = sound(&crashed).await;
        assert_eq!(after.holds.unwrap().schema as usize, newest);
    }
    assert!(seen.into_iter().eq(schemas.into_keys().skip(1)), "every version is seen on the way");
}

#[tokio::test(flavor = "multi_thread")]
async fn a_database_of_a_newer_version_is_refused_and_left_alone() {
    let folder = tempfile::tempdir().unwrap();
    let (database, backup) = (folder.path().join("newer.db"), folder.path().join("backup.db"));
    std::fs::write(&database, &fixtures::databases()["0002_models"]).unwrap();
    let mut db = SqliteConnectOptions::new().filename(&database).connect().await.unwrap();
    let insert = "insert into _sqlx_migrations (version, description, success, checksum, execution_time)
        values (9999, 'from the future', 1, x'00', 1)";
    db.execute(insert).await.unwrap();
    db.close().await.unwrap();
    let (from, to) = (url(&database), backup.display().to_string());
    let before = std::fs::read(&database).unwrap();
    for arguments in [
        vec!["serve", "--listen", "127.0.0.1:0", "--database", &from],
        vec!["check", "--database", &from],
        vec!["restore", "--database", &url(&folder.path().join("other.db")), &database.display().to_string()],
    ] {
        revisit(&arguments).refused("the database has schema 9999, and this version of revisit knows");
    }
    // A copy does not have to understand what it copies.
    revisit(&["backup", "--database", &from, &to]).well();
    assert!(before == std::fs::read(&database).unwrap());
}
