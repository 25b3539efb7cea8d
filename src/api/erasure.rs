//! Erasure: keyframes and sessions that leave for good (`openapi/openapi.yaml`).

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::decoding::read::{self, Decode, Node};
use super::limits;
use super::names::ErasureStateName;
use super::space::Time;
use crate::domain::erasure::{Erasure, NewErasure};
use crate::domain::ids::{BackupId, KeyframeId, SessionId};

/// What is to be erased. Exactly one of `keyframes` and `sessions`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct ErasureBody {
    /// Keyframes, by id. One that the map does not have any more is erased from its releases, and from what is left of it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(min_items = 1, max_items = 10000)]
    pub keyframes: Option<Vec<String>>,
    /// Whole sessions, by name.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(min_items = 1, max_items = 1000)]
    pub sessions: Option<Vec<String>>,
}

/// An erasure, as far as it has come.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(as = Erasure)]
pub struct ErasureView {
    /// Its id.
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
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ended: Option<Time>,
    /// The backups in the server's folder that were taken before it was done, and still hold what it erased.
    pub older_backups: Vec<String>,
}

impl Decode for NewErasure {
    fn decode(node: &Node<'_>) -> Option<Self> {
        let body = node.object(&["keyframes", "sessions"])?;
        let keyframes = body
            .optional("keyframes", |node| some_of(node, limits::ERASED_KEYFRAMES, read::id::<KeyframeId>));
        let sessions =
            body.optional("sessions", |node| some_of(node, limits::ERASED_SESSIONS, read::id::<SessionId>));
        if body.has("keyframes") == body.has("sessions") {
            return node.refuse("erase keyframes or sessions", "either \"keyframes\" or \"sessions\"");
        }
        match (keyframes?, sessions?) {
            (Some(keyframes), _) => Some(Self::Keyframes(keyframes)),
            (None, sessions) => sessions.map(Self::Sessions),
        }
    }
}

fn some_of<T>(node: &Node<'_>, most: usize, read: impl FnMut(&Node<'_>) -> Option<T>) -> Option<Vec<T>> {
    let list = node.list(most, read)?;
    if list.is_empty() { node.refuse("the list is empty", "one or more") } else { Some(list) }
}

impl ErasureView {
    /// Returns an erasure, with the backups that are older.
    pub fn of(erasure: Erasure, older_backups: Vec<BackupId>) -> Self {
        let Erasure { number, state, keyframes, releases, begun, ended } = erasure;
        Self {
            id: format!("e-{number}"),
            state: state.into(),
            keyframes,
            releases,
            begun: begun.into(),
            ended: ended.map(Time::from),
            older_backups: older_backups.into_iter().map(|id| id.to_string()).collect(),
        }
    }
}
