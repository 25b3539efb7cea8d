//! What can go wrong with the database.

use thiserror::Error;

/// Why the database did not do what it was asked.
#[derive(Clone, Debug, Error)]
pub enum StoreError {
    /// The disk is full; nothing was written, and reads go on.
    #[error("the disk is full")]
    DiskFull,
    /// The database answers with an error.
    #[error("database: {0}")]
    Database(String),
    /// A row does not hold what this version writes.
    #[error("the database holds what no version of this program writes: {0}")]
    Corrupt(String),
    /// The SQLite that this program was linked with may lose acknowledged writes.
    #[error("SQLite {found} may lose committed writes in WAL mode; at least {needed} is needed")]
    SqliteTooOld {
        /// The version linked.
        found: String,
        /// The oldest version that is safe.
        needed: &'static str,
    },
    /// An earlier write to the same map failed; what was planned upon it is void.
    #[error("an earlier write to this map failed; try again")]
    Superseded,
    /// Every connection to the database was busy for too long.
    #[error("the database is busy")]
    Busy,
    /// The store is closed.
    #[error("the store is closed")]
    Closed,
}

impl StoreError {
    pub(super) fn corrupt(what: impl Into<String>) -> Self {
        Self::Corrupt(what.into())
    }
}

impl From<sqlx::Error> for StoreError {
    fn from(error: sqlx::Error) -> Self {
        /// SQLITE_FULL; extended codes carry the primary one in their low byte.
        const FULL: i32 = 13;
        let code = error
            .as_database_error()
            .and_then(sqlx::error::DatabaseError::code)
            .and_then(|code| code.parse::<i32>().ok());
        match code {
            Some(code) if code & 0xff == FULL => Self::DiskFull,
            _ if matches!(error, sqlx::Error::PoolTimedOut) => Self::Busy,
            _ => Self::Database(error.to_string()),
        }
    }
}
