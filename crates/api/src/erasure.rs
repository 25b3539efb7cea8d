//! Erasure: keyframes and sessions that leave for good (`openapi/openapi.yaml`).

use revisit_core::domain::erasure::{Erasure, NewErasure};
use revisit_core::domain::ids::{BackupId, KeyframeId, SessionId};
use revisit_shapes::{answer, body};

use super::decoding::read::Node;
use super::names::ErasureStateName;
use super::space::Time;

/// What is to be erased. Exactly one of `keyframes` and `sessions`.
#[body(checked NewErasure)]
#[derive(Default)]
pub struct ErasureBody {
    /// Keyframes, by id. One that the map does not have any more is erased from its releases, and from what is left of it.
    #[schema(min_items = 1, max_items = 10000)]
    #[id]
    pub keyframes: Option<Vec<KeyframeId>>,
    /// Whole sessions, by name.
    #[schema(min_items = 1, max_items = 1000)]
    #[id]
    pub sessions: Option<Vec<SessionId>>,
}

/// An erasure, as far as it has come.
#[answer(of = Erasure)]
#[schema(as = Erasure)]
pub struct ErasureView {
    /// Its id.
    #[is(format!("e-{}", of.number))]
    pub id: String,
    /// Its state. It goes on after a restart, until it is `done`.
    pub state: ErasureStateName,
    /// Number of keyframes that were removed from the map.
    pub keyframes: u64,
    /// Number of releases that keyframes were removed from.
    pub releases: u64,
    /// When it was asked for.
    pub begun: Time,
    /// When it was done; left out before that.
    pub ended: Option<Time>,
    /// The backups in the server's folder that were taken before it was done, and still hold what it erased.
    #[is(Vec::new())]
    pub older_backups: Vec<String>,
}

impl ErasureBody {
    fn checked(self, node: &Node<'_>) -> Option<NewErasure> {
        match (self.keyframes, self.sessions) {
            (Some(keyframes), None) => Some(NewErasure::Keyframes(keyframes)),
            (None, Some(sessions)) => Some(NewErasure::Sessions(sessions)),
            _ => node.refuse("erase keyframes or sessions", "either \"keyframes\" or \"sessions\""),
        }
    }
}

impl ErasureView {
    /// Returns an erasure, with the backups that are older.
    pub fn of(erasure: Erasure, older_backups: &[BackupId]) -> Self {
        Self { older_backups: older_backups.iter().map(ToString::to_string).collect(), ..erasure.into() }
    }
}
