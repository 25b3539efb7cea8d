//! Erasures: keyframes and sessions that leave a map, its releases and the disk for good.

use super::ids::{KeyframeId, SessionId};
use super::keyframe::Stamp;
use crate::named::named;

/// The request for an erasure: keyframes or whole sessions, never both.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum NewErasure {
    /// These keyframes; one that was deleted before is erased from what is left of it.
    Keyframes(Vec<KeyframeId>),
    /// All keyframes of these sessions, and the sessions' names.
    Sessions(Vec<SessionId>),
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
