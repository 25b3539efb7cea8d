//! Check: is a database whole, and does every map in it hold the law?
//!
//! | what | file |
//! |---|---|
//! | what SQLite itself can find | this file |
//! | one map: its index, and what only the store keeps | [`map`], [`rows`] |
//!
//! Nothing is written. What it cannot find: writes that a shortened log no longer holds, once its index is gone; a value that was replaced by another one that could have stood there, as
//! SQLite keeps no checksums; a last detection or a setting that is gone without a trace.

mod map;
mod rows;

use std::path::Path;

use sqlx::{ConnectOptions as _, Connection as _, SqliteConnection};

pub use map::MapCheck;

use super::StoreError;
use super::backup::{Holdings, holdings};
use super::files::lock::DatabaseLock;
use super::files::paths::DatabaseFiles;
use super::files::{log, schema};
use crate::domain::ids::{MapId, StoredId as _};

/// SQLite stops looking after so many faults.
const STRUCTURAL_FAULTS_MAX: usize = 100;

/// At most so many faults are told of one map; a torn table has one in every row.
const MAP_FAULTS_MAX: usize = 100;

/// What was found in a database.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Checked {
    /// What it holds, if that can be counted.
    pub holds: Option<Holdings>,
    /// Faults of the database as a whole.
    pub faults: Vec<String>,
    /// What cannot be told, and is no fault.
    pub notes: Vec<String>,
    /// Each map, by name. None where the schema is older than this program's: they are read after its migration.
    pub maps: Vec<MapCheck>,
    /// The schema is older than this program's.
    pub is_older: bool,
    /// The schema's version, if it is newer than this program's: nothing but the structure was looked into.
    pub(super) newer: Option<i64>,
}

impl Checked {
    /// Every fault, those of a map under its name.
    pub fn all_faults(&self) -> impl Iterator<Item = String> + '_ {
        let of_maps = self.maps.iter().flat_map(|map| {
            let id = &map.id;
            map.faults.iter().map(move |fault| format!("map {id}: {fault}"))
        });
        self.faults.iter().cloned().chain(of_maps)
    }
}

/// Checks the database, also beside a running server, in one read transaction. Fails if there is nothing to look at.
///
/// `check`, `backup` and `restore` share it: a file that it finds faults in is not restored, and no backup of that content
/// is called verified.
pub async fn check(files: &DatabaseFiles) -> Result<Checked, StoreError> {
    match check_any_schema(files).await? {
        Checked { newer: Some(found), .. } => Err(StoreError::Newer { found, known: schema::newest() }),
        checked => Ok(checked),
    }
}

/// The same for a database of any version; maps of a newer one are not looked into.
pub(super) async fn check_any_schema(files: &DatabaseFiles) -> Result<Checked, StoreError> {
    if !files.database().is_file() {
        return Err(StoreError::File {
            path: files.database().display().to_string(),
            error: "there is no such file".to_owned(),
        });
    }
    // Without a log nobody has it open: then it is read as if it could not change, which needs no files beside it,
    // and the lock keeps a server from starting meanwhile.
    let is_closed = !files.wal().exists();
    let _closed = is_closed.then(|| DatabaseLock::share(files));
    let log = log::look(files)?;
    let options =
        if is_closed { files.read_only().immutable(true) } else { files.untouched(!log.faults.is_empty()) };
    let mut db = match options.connect().await {
        Ok(db) => db,
        Err(error) => return Ok(Checked { faults: vec![error.to_string()], ..Checked::default() }),
    };
    let mut transaction = db.begin().await?;
    let mut checked = check_all(&mut transaction).await;
    if let (true, Ok(checked @ Checked { holds: Some(_), .. })) = (is_closed, &mut checked) {
        note(&mut checked.faults, wrong_length(&mut transaction, files.database()).await);
    }
    transaction.rollback().await?;
    db.close().await?;
    let mut checked = checked?;
    checked.faults.extend(log.faults);
    checked.notes.extend(log.notes);
    Ok(checked)
}

async fn check_all(db: &mut SqliteConnection) -> Result<Checked, StoreError> {
    let mut checked = Checked::default();
    match structural_faults(&mut *db).await {
        Ok(faults) => checked.faults.extend(faults),
        // Not even that: what follows would say the same again.
        Err(error) => {
            checked.faults.push(error.to_string());
            return Ok(checked);
        }
    }
    match schema::version(&mut *db).await {
        Ok(version) if version > schema::newest() => {
            checked.newer = Some(version);
            return Ok(checked);
        }
        Ok(version) => checked.is_older = version < schema::newest(),
        Err(error) => {
            checked.faults.push(format!("not a database of revisit: {error}"));
            return Ok(checked);
        }
    }
    note(&mut checked.faults, dangling_rows(&mut *db).await);
    match holdings(&mut *db).await {
        Ok(holds) => checked.holds = Some(holds),
        Err(error) => checked.faults.push(error.to_string()),
    }
    if checked.is_older {
        return Ok(checked);
    }
    let ids: Result<Vec<String>, _> =
        sqlx::query_scalar("select id from maps where deleted = 0 order by id").fetch_all(&mut *db).await;
    let ids = ids.unwrap_or_else(|error| {
        checked.faults.push(error.to_string());
        Vec::new()
    });
    for id in ids {
        match MapId::stored(&id) {
            Ok(id) => checked.maps.push(map::check(&mut *db, &id).await),
            Err(error) => checked.faults.push(format!("map {id:?}: {error}")),
        }
    }
    Ok(checked)
}

fn note(faults: &mut Vec<String>, found: Result<Vec<String>, StoreError>) {
    match found {
        Ok(found) => faults.extend(found),
        Err(error) => faults.push(error.to_string()),
    }
}

/// What SQLite finds wrong with pages, rows and indexes.
async fn structural_faults(db: &mut SqliteConnection) -> Result<Vec<String>, StoreError> {
    let found: Vec<String> = sqlx::query_scalar("pragma integrity_check").fetch_all(db).await?;
    Ok(found.into_iter().filter(|line| line != "ok").take(STRUCTURAL_FAULTS_MAX).collect())
}

/// A file without a log is as long as its pages are; of a shorter one SQLite reads zeros.
async fn wrong_length(db: &mut SqliteConnection, file: &Path) -> Result<Vec<String>, StoreError> {
    let select = "select page_count * page_size from pragma_page_count, pragma_page_size";
    let expected: i64 = sqlx::query_scalar(select).fetch_one(db).await?;
    let length = std::fs::metadata(file).map_err(|error| StoreError::file(file, &error))?.len();
    let fault = format!("the file has {length} bytes, and its pages {expected}");
    Ok(if length == expected as u64 { Vec::new() } else { vec![fault] })
}

/// Rows that refer to rows which are not there, by table.
async fn dangling_rows(db: &mut SqliteConnection) -> Result<Vec<String>, StoreError> {
    let select =
        "select \"table\", parent, count(*) from pragma_foreign_key_check group by 1, 2 order by 1, 2";
    let found: Vec<(String, String, i64)> = sqlx::query_as(select).fetch_all(db).await?;
    let told = |(table, parent, count)| {
        format!("{count} rows of {table} refer to rows of {parent} that are not there")
    };
    Ok(found.into_iter().map(told).collect())
}
