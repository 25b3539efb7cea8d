//! Service: how the server is.

use revisit_shapes::answer;

/// The state of the server.
#[answer]
pub struct Health {
    /// `alive`, `ready` or `degraded`; a server that is not ready answers a problem.
    pub status: String,
    /// One sentence for a person, if it is degraded: why.
    pub detail: Option<String>,
}

impl Health {
    /// The server is in this state.
    pub fn of(status: &str) -> Self {
        Self { status: status.to_owned(), detail: None }
    }

    /// The server is ready for a part of all requests.
    pub fn degraded(detail: &str) -> Self {
        Self { status: "degraded".to_owned(), detail: Some(detail.to_owned()) }
    }
}

/// The running program.
#[answer]
pub struct Version {
    /// The program.
    pub name: String,
    /// Its version.
    pub version: String,
    /// The version of SQLite inside it.
    pub sqlite: String,
    /// The version of the PostgreSQL that keeps its facts; missing where SQLite does.
    pub postgres: Option<String>,
    /// The vocabulary with which it computes bags of words; null while it has none.
    #[schema(required)]
    #[null]
    pub vocabulary: Option<String>,
}
