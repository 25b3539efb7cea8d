//! Standing: the right by which this server has a map in memory.

use std::sync::Arc;
use std::time::Instant;

use crate::store::Lease;

/// The right by which this server has a map in memory.
#[derive(Debug)]
pub(in crate::engine) enum Standing {
    /// No other server can have it.
    Alone,
    /// It owns the map, where others could.
    Owner(Arc<Lease>),
    /// Another server may own it. This one reads a copy, and writes nothing.
    Follower {
        /// Rewrites of the map before it was loaded.
        rewrites: i64,
        /// When it was loaded.
        since: Instant,
    },
}

impl Standing {
    /// Returns the lease of an owner among others.
    pub fn lease(&self) -> Option<&Lease> {
        match self {
            Self::Owner(lease) => Some(lease),
            Self::Alone | Self::Follower { .. } => None,
        }
    }

    /// Returns how often a map that is followed had been rewritten before it was loaded, and when that was.
    pub fn followed_since(&self) -> Option<(i64, Instant)> {
        match self {
            Self::Follower { rewrites, since } => Some((*rewrites, *since)),
            Self::Alone | Self::Owner(_) => None,
        }
    }
}
