//! What a use case can answer instead of its result.

use std::str::FromStr;

use thiserror::Error;

use crate::domain::invalid::FieldError;
use crate::domain::request::PageRequest;
use crate::store::StoreError;

/// The result of a use case, or the error that it answers with instead.
pub type Result<T, E = ServiceError> = std::result::Result<T, E>;

/// Why a request was not served.
#[derive(Clone, Debug, Error)]
pub enum ServiceError {
    /// The resource does not exist; the text names it.
    #[error("{0}")]
    NotFound(String),
    /// The request contradicts what is stored.
    #[error("{detail}")]
    Conflict {
        /// A name for programs.
        code: &'static str,
        /// A sentence for people.
        detail: String,
    },
    /// What the request continues is gone.
    #[error("{0}")]
    Gone(String),
    /// The thing has another version than the client believes.
    #[error("{0}")]
    PreconditionFailed(String),
    /// The body means nothing here; every offending field is named.
    #[error("{} fields of the body cannot be accepted", .0.len())]
    Invalid(Vec<FieldError>),
    /// The request or the map is too large.
    #[error("{0}")]
    TooLarge(String),
    /// The disk is full: writes are refused, reads and deletes go on.
    #[error("the disk is full; nothing was written")]
    DiskFull,
    /// The map's quota is used up: writes to it are refused, reads and deletes go on.
    #[error("{0}")]
    MapFull(String),
    /// Not now.
    #[error("{detail}")]
    Unavailable {
        /// A sentence for people.
        detail: String,
        /// When to try again, in seconds.
        retry_after_s: u32,
    },
    /// There is more to do than can be done; nothing was begun.
    #[error("{0}")]
    Overloaded(String),
    /// A map is damaged on disk; the text names the map and the row.
    #[error("{0}")]
    Damaged(String),
    /// A backup was taken of a database that is damaged; the text says where it lies and what is wrong.
    #[error("{0}")]
    NotVerified(String),
    /// Something here is broken; the text is for the log.
    #[error("{0}")]
    Internal(String),
}

impl ServiceError {
    /// Returns the error of a service that is closing.
    pub(super) fn closed() -> Self {
        Self::unavailable("the service is closing")
    }

    /// Returns the error of what may well be served a second later.
    pub(super) fn unavailable(detail: impl Into<String>) -> Self {
        Self::Unavailable { detail: detail.into(), retry_after_s: 1 }
    }

    pub(super) fn panicked(error: tokio::task::JoinError) -> Self {
        Self::Internal(format!("a decision did not finish: {error}"))
    }

    /// Says that a map is not there, and how to make it.
    pub fn no_map(id: impl std::fmt::Display) -> Self {
        Self::NotFound(format!("there is no map {id}; `PUT /v1/maps/{id}` with {{}} as its body makes one"))
    }

    pub(super) fn no_keyframe(id: impl std::fmt::Display) -> Self {
        Self::NotFound(format!("there is no keyframe {id} in this map"))
    }

    pub(super) fn no_anchor(id: impl std::fmt::Display) -> Self {
        Self::NotFound(format!("there is no anchor {id} in this map"))
    }

    /// Returns the error of a cursor that this server did not give.
    pub(super) fn bad_cursor(cursor: &str) -> Self {
        FieldError::new("?cursor", "is not a cursor that this server gave").got(cursor).into()
    }
}

/// Reads the cursor of a page, which this server gave.
pub(super) fn parsed<T: FromStr>(page: &PageRequest) -> Result<Option<T>> {
    let cursor = page.cursor.as_deref();
    cursor.map(|cursor| cursor.parse().map_err(|_| ServiceError::bad_cursor(cursor))).transpose()
}

/// Refuses what has faults.
pub(super) fn refuse(faults: Vec<FieldError>) -> Result<()> {
    if faults.is_empty() { Ok(()) } else { Err(ServiceError::Invalid(faults)) }
}

impl From<FieldError> for ServiceError {
    fn from(fault: FieldError) -> Self {
        Self::Invalid(vec![fault])
    }
}

impl From<StoreError> for ServiceError {
    fn from(error: StoreError) -> Self {
        match error {
            StoreError::DiskFull => Self::DiskFull,
            StoreError::Superseded
            | StoreError::Closed
            | StoreError::Busy
            | StoreError::Fenced
            | StoreError::Away(_)
            | StoreError::Disk(_) => Self::unavailable(error.to_string()),
            StoreError::Damaged { .. } => Self::Damaged(format!("{error}; other maps are not affected")),
            StoreError::Database(_)
            | StoreError::Corrupt(_)
            | StoreError::SqliteTooOld { .. }
            | StoreError::UnknownForm
            | StoreError::Newer { .. }
            | StoreError::OldServers { .. }
            | StoreError::InUse(_)
            | StoreError::Exists(_)
            | StoreError::File { .. } => Self::Internal(error.to_string()),
        }
    }
}
