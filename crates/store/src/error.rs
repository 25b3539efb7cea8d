//! What can go wrong with the database.

use std::fmt::Display;
use std::io;
use std::path::Path;

use sqlx::sqlite::SqliteError;
use thiserror::Error;

/// Why the database did not do what it was asked.
#[derive(Clone, Debug, Error)]
pub enum StoreError {
    /// The disk is full; nothing was written, and reads go on.
    #[error("the disk is full")]
    DiskFull,
    /// The disk does not do what it is told, or gives back what was not written; whether what was being written is on it
    /// is not known before the next commit.
    #[error("the disk failed, or the file is damaged or not readable: {0}")]
    Disk(String),
    /// The database server does not answer, or only reads; whether what was being written is kept is not known before the map
    /// is loaded again.
    #[error("the database server is away: {0}")]
    Away(String),
    /// The database answers with an error.
    #[error("database: {0}")]
    Database(String),
    /// A row does not hold what this version writes.
    #[error("the database holds what no version of this program writes: {0}")]
    Corrupt(String),
    /// A row of a map does not hold what this version writes; other maps are not affected.
    #[error("map {map} is damaged on disk: {fault}")]
    Damaged {
        /// The map's name.
        map: String,
        /// The row and what is wrong with it.
        fault: String,
    },
    /// The SQLite that this program was linked with may lose acknowledged writes.
    #[error("SQLite {found} may lose committed writes in WAL mode; at least {needed} is needed")]
    SqliteTooOld {
        /// The version linked.
        found: String,
        /// The oldest version that is safe.
        needed: &'static str,
    },
    /// Another program has made the database, or a build of this one that is not among its versions.
    #[error(
        "this version of revisit cannot read the database: if another build of revisit made it, export its maps with that build, \
         and replay them into a new database"
    )]
    UnknownForm,
    /// A newer version of this program has written the database.
    #[error(
        "the database has schema {found}, and this version of revisit knows {known} at most: it was opened by a newer \
         version; run that one, or restore a backup from before the upgrade"
    )]
    Newer {
        /// The schema's version in the database.
        found: i64,
        /// The newest version known here.
        known: i64,
    },
    /// Servers have the database open that could not work with this version's schema.
    #[error(
        "this version needs schema {oldest} of every server, and one that has the database open knows {known} at most: upgrade \
         the servers to the version before this one first, or stop them"
    )]
    OldServers {
        /// The newest version that such a server knows.
        known: i64,
        /// The oldest version that it must know.
        oldest: i64,
    },
    /// Another process has the database open, and only one may.
    #[error("{0}")]
    InUse(String),
    /// A file that is to be written is there already.
    #[error("{0} exists; --force replaces it")]
    Exists(String),
    /// A file cannot be read or written.
    #[error("{path}: {error}")]
    File {
        /// The file.
        path: String,
        /// What the system says.
        error: String,
    },
    /// An earlier write to the same map failed; what was planned upon it is void.
    #[error("an earlier write to this map failed; try again")]
    Superseded,
    /// Every connection to the database was busy for too long.
    #[error("the database is busy")]
    Busy,
    /// Another server owns the map by now; nothing was written.
    #[error("another server owns this map now; try again")]
    Fenced,
    /// The store is closed.
    #[error("the store is closed")]
    Closed,
}

impl StoreError {
    /// Returns what the system says about a file.
    pub fn file(path: &Path, error: &io::Error) -> Self {
        match error.kind() {
            io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => Self::DiskFull,
            _ => Self::File { path: path.display().to_string(), error: error.to_string() },
        }
    }

    /// Returns the same error, naming the database where its text does not.
    pub(super) fn of(self, database: &Path) -> Self {
        let named = |what: String| format!("{}: {what}", database.display());
        match self {
            Self::Database(what) => Self::Database(named(what)),
            Self::Disk(what) => Self::Disk(named(what)),
            Self::Corrupt(what) => Self::Corrupt(named(what)),
            named => named,
        }
    }

    /// Returns the error of data that does not decode, or that contradicts itself.
    pub fn corrupt(what: impl Into<String>) -> Self {
        Self::Corrupt(what.into())
    }

    /// Names the row in which a value does not decode; other errors stay as they are.
    pub(super) fn of_row(self, row: impl Display) -> Self {
        match self {
            Self::Corrupt(fault) => Self::Corrupt(format!("{row}: {fault}")),
            other => other,
        }
    }

    /// Names the map in which a row does not decode; other errors stay as they are.
    pub(super) fn of_map(self, map: impl Display) -> Self {
        match self {
            Self::Corrupt(fault) => Self::Damaged { map: map.to_string(), fault },
            other => other,
        }
    }

    /// Returns what is wrong, without the map's name.
    pub fn fault(self) -> String {
        match self {
            Self::Damaged { fault, .. } => fault,
            other => other.to_string(),
        }
    }
}

impl From<sqlx::Error> for StoreError {
    fn from(error: sqlx::Error) -> Self {
        /// SQLITE_FULL; extended codes carry the primary one in their low byte.
        const FULL: i32 = 13;
        /// SQLITE_IOERR, SQLITE_CANTOPEN, and SQLITE_CORRUPT: a read that fails with EIO arrives as the last, and what SQLite
        /// calls malformed must take no more writes, either.
        const FAILED: [i32; 3] = [10, 11, 14];
        let code = error.as_database_error().and_then(sqlx::error::DatabaseError::code);
        if let Some(of_server) = of_server(&error, code.as_deref()) {
            return of_server;
        }
        let code = code.and_then(|code| code.parse::<i32>().ok());
        match code {
            Some(code) if code & 0xff == FULL => Self::DiskFull,
            Some(code) if FAILED.contains(&(code & 0xff)) => Self::Disk(error.to_string()),
            _ if matches!(error, sqlx::Error::PoolTimedOut) => Self::Busy,
            _ if matches!(error, sqlx::Error::ColumnDecode { .. }) => Self::Corrupt(error.to_string()),
            _ => Self::Database(error.to_string()),
        }
    }
}

/// Returns what an error of a database server or of the way to it means; `None` where it means nothing special, or is SQLite's.
fn of_server(error: &sqlx::Error, code: Option<&str>) -> Option<StoreError> {
    let is_sqlite =
        error.as_database_error().is_some_and(|error| error.try_downcast_ref::<SqliteError>().is_some());
    if is_sqlite {
        return None;
    }
    let code = match error {
        sqlx::Error::Io(_) | sqlx::Error::Tls(_) | sqlx::Error::Protocol(_) => {
            return Some(StoreError::Away(error.to_string()));
        }
        _ => code?,
    };
    match code {
        // disk_full
        "53100" => Some(StoreError::DiskFull),
        // too_many_connections; lock_not_available: a server that fell silent within a write holds it, for some seconds more at most.
        "53300" | "55P03" => Some(StoreError::Busy),
        // idle_in_transaction_session_timeout: this server was stopped within a write. read_only_sql_transaction: after a fail-over the connection leads to a server that only reads. The others say that the
        // server stops, starts or cannot be reached.
        "25006" | "25P03" | "57P01" | "57P02" | "57P03" => Some(StoreError::Away(error.to_string())),
        _ if code.starts_with("08") => Some(StoreError::Away(error.to_string())),
        _ => None,
    }
}
