//! Inspection: a database is looked at as it is, also beside a running server, and nothing is written.

mod rows;

use std::fs::File;
use std::path::Path;

use revisit_core::domain::change::Change;
use revisit_core::domain::ids::{MapId, StoredId as _};
use sqlx::ConnectOptions as _;

use super::StoreError;
use super::facts::{FactSource, MapFacts, Order};
use super::files::lock::DatabaseLock;
use super::files::log::{self, LogFindings};
use super::files::paths::DatabaseFiles;
use super::files::schema;
use super::holdings::{Holdings, holdings};
use super::loading::load::load;
use crate::sql::{self, Connection};
pub use rows::RowFindings;

/// The most faults that SQLite lists before it stops looking.
const STRUCTURAL_FAULTS_MAX: usize = 100;

/// The files of a database, kept from a server that would start meanwhile.
#[derive(Debug)]
pub struct Inspection {
    files: DatabaseFiles,
    /// No process has it open.
    is_closed: bool,
    _shared: Option<File>,
    /// Findings in its log.
    pub log: LogFindings,
}

/// The database within one read transaction.
#[derive(Debug)]
pub struct Inspected {
    db: Connection,
}

impl Inspection {
    /// Looks at the files. Fails if there are none.
    pub fn of(files: &DatabaseFiles) -> Result<Self, StoreError> {
        if !files.database().is_file() {
            return Err(StoreError::File {
                path: files.database().display().to_string(),
                error: "there is no such file".to_owned(),
            });
        }
        // Without a log no process has it open: then it is read as if it could not change, which needs no files beside
        // it, and the lock keeps a server from starting meanwhile.
        let is_closed = !files.wal().exists();
        let shared = if is_closed { DatabaseLock::share(files) } else { None };
        let log = log::look(files)?;
        Ok(Self { files: files.clone(), is_closed, _shared: shared, log })
    }

    /// Opens the database.
    pub async fn open(&self) -> Result<Inspected, StoreError> {
        let options = if self.is_closed {
            self.files.read_only().immutable(true)
        } else {
            self.files.untouched(!self.log.faults.is_empty())
        };
        let mut db = Connection::Sqlite(options.connect().await?);
        sql::query("begin").execute(&mut db).await?;
        Ok(Inspected { db })
    }

    /// Finds a file without a log that is not as long as its pages are: of a shorter one SQLite reads zeros.
    pub async fn wrong_length(&self, inspected: &mut Inspected) -> Result<Vec<String>, StoreError> {
        if !self.is_closed {
            return Ok(Vec::new());
        }
        wrong_length(&mut inspected.db, self.files.database()).await
    }
}

impl Inspected {
    /// Finds what SQLite finds wrong with pages, rows and indexes.
    pub async fn structural_faults(&mut self) -> Result<Vec<String>, StoreError> {
        let found: Vec<String> = sql::query_scalar("pragma integrity_check").fetch_all(&mut self.db).await?;
        Ok(found.into_iter().filter(|line| line != "ok").take(STRUCTURAL_FAULTS_MAX).collect())
    }

    /// Returns the schema's version.
    pub async fn schema(&mut self) -> Result<i64, StoreError> {
        schema::version(&mut self.db).await
    }

    /// Counts what it holds.
    pub async fn holdings(&mut self) -> Result<Holdings, StoreError> {
        holdings(&mut self.db).await
    }

    /// Finds rows that refer to rows which are not there, by table.
    pub async fn dangling_rows(&mut self) -> Result<Vec<String>, StoreError> {
        let select =
            "select \"table\", parent, count(*) from pragma_foreign_key_check group by 1, 2 order by 1, 2";
        let found: Vec<(String, String, i64)> = sql::query_as(select).fetch_all(&mut self.db).await?;
        let told = |(table, parent, count)| {
            format!("{count} rows of {table} refer to rows of {parent} that are not there")
        };
        Ok(found.into_iter().map(told).collect())
    }

    /// Finds keys of maps above the one that was given last: they would be given twice.
    pub async fn key_faults(&mut self) -> Result<Vec<String>, StoreError> {
        let select = "select id, map_key from maps where map_key > (select last from counters where name = 'map') order by map_key";
        let found: Vec<(String, i64)> = sql::query_as(select).fetch_all(&mut self.db).await?;
        let told = |(id, key)| format!("map {id} has key {key}, which would be given again");
        Ok(found.into_iter().map(told).collect())
    }

    /// Returns the maps by name; a name that is none is a fault.
    pub async fn maps(&mut self) -> Result<Vec<Result<MapId, String>>, StoreError> {
        let select = "select id from maps where deleted = 0 order by id";
        let ids: Vec<String> = sql::query_scalar(select).fetch_all(&mut self.db).await?;
        let named = |id: String| MapId::stored(&id).map_err(|error| format!("map {id:?}: {error}"));
        Ok(ids.into_iter().map(named).collect())
    }

    /// Checks the rows of a map that no index holds. `fit` tells whether features can be matched.
    pub async fn check_rows(
        &mut self,
        facts: &MapFacts,
        fit: rows::Fit,
        found: &mut RowFindings,
    ) -> Result<(), StoreError> {
        rows::check(&mut self.db, facts, fit, found).await
    }

    /// Ends the transaction, and closes the database.
    pub async fn close(mut self) -> Result<(), StoreError> {
        sql::query("rollback").execute(&mut self.db).await?;
        Ok(self.db.close().await?)
    }
}

impl FactSource for &mut Inspected {
    async fn load(
        &mut self,
        id: &MapId,
        order: Order,
        take: impl FnMut(Vec<Change>) + Send,
    ) -> Result<Option<MapFacts>, StoreError> {
        load(&mut self.db, id, order, take).await
    }
}

async fn wrong_length(db: &mut Connection, file: &Path) -> Result<Vec<String>, StoreError> {
    let select = "select page_count * page_size from pragma_page_count, pragma_page_size";
    let expected: i64 = sql::query_scalar(select).fetch_one(db).await?;
    let length = std::fs::metadata(file).map_err(|error| StoreError::file(file, &error))?.len();
    let fault = format!("the file has {length} bytes, and its pages {expected}");
    Ok(if length == expected as u64 { Vec::new() } else { vec![fault] })
}
