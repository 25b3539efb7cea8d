//! Erasures: keyframes and sessions that leave a map, its releases and the disk for good.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::ids::{KeyframeId, ReleaseName, SessionId};
use super::keyframe::Stamp;
use crate::named::named;

/// The request for an erasure: keyframes or whole sessions, never both.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum NewErasure {
    /// These keyframes; one that was deleted before is erased from what is left of it.
    Keyframes(Vec<KeyframeId>),
    /// All keyframes of these sessions, and the sessions' names.
    Sessions(Vec<SessionId>),
}

/// A session that is a part of another one, in the map as it stands or in a release of it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MergedInVersion {
    /// The release; none: the map as it stands.
    pub release: Option<ReleaseName>,
    /// The session that went.
    pub session: SessionId,
    /// The session that its keyframes are of from then on.
    pub into: SessionId,
}

/// Returns sessions with all that merged into them in any version of the map, each with the place of the one that it is of: a
/// session is what was sent as it, with every merge that any version knows.
pub fn with_merged<'a>(
    sessions: &'a [SessionId],
    merges: &'a [MergedInVersion],
) -> BTreeMap<&'a SessionId, usize> {
    let mut parts: BTreeMap<&SessionId, Vec<&SessionId>> = BTreeMap::new();
    for merge in merges {
        parts.entry(&merge.into).or_default().push(&merge.session);
    }
    let mut all = BTreeMap::new();
    let mut open: Vec<(&SessionId, usize)> = sessions.iter().enumerate().map(|(at, one)| (one, at)).collect();
    while let Some((session, at)) = open.pop() {
        if all.insert(session, at).is_none() {
            open.extend(parts.get(session).into_iter().flatten().map(|part| (*part, at)));
        }
    }
    all
}

named! {
    /// The state of an erasure.
    ErasureState {
        /// What is to be erased is being removed from the map and its releases.
        Removing = "removing",
        /// It is removed, and the database's file is being rewritten without it.
        Rewriting = "rewriting",
        /// No byte of it is left in the database and its log.
        Done = "done",
    }
}

/// An erasure, as far as it has come.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Erasure {
    /// Its number in its map, from 1.
    pub number: u64,
    /// Its state.
    pub state: ErasureState,
    /// Number of keyframes that were removed from the map.
    pub keyframes: u64,
    /// Number of releases that keyframes were removed from.
    pub releases: u64,
    /// When it was asked for.
    pub begun: Stamp,
    /// When it was done.
    pub ended: Option<Stamp>,
}
