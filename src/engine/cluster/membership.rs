//! Membership: this server among those that share its database, and what it knows of them.

use std::sync::{Arc, PoisonError, RwLock};
use std::time::Duration;

use moka::sync::Cache;

use super::placement::placed;
use crate::domain::ids::MapId;
use crate::store::Node;

/// An owner is asked for again after this time. A map that moves meanwhile is answered with 503, as while it moves.
const OWNER_LASTS: Duration = Duration::from_millis(500);

/// The most owners that are kept.
const OWNERS_MAX: u64 = 10_000;

/// This server among those that share its database.
#[derive(Debug)]
pub(in crate::engine) struct Membership {
    /// This server.
    pub(super) this: Node,
    /// The servers that are there, this one among them, as of the last renewal.
    nodes: RwLock<Arc<[Node]>>,
    /// The owners of maps that other servers have, as the database said a moment ago.
    owners: Cache<MapId, String>,
}

impl Membership {
    pub(super) fn of(this: Node, nodes: Vec<Node>) -> Arc<Self> {
        let owners = Cache::builder().max_capacity(OWNERS_MAX).time_to_live(OWNER_LASTS).build();
        Arc::new(Self { this, nodes: RwLock::new(nodes.into()), owners })
    }

    /// Returns the owner of a map that another server had a moment ago.
    pub(super) fn owner_before(&self, map: &MapId) -> Option<Node> {
        self.node(&self.owners.get(map)?)
    }

    /// Notes that another server has a map.
    pub(super) fn note_owner(&self, map: &MapId, owner: &str) {
        self.owners.insert(map.clone(), owner.to_owned());
    }

    /// Forgets who has a map: that server did not answer.
    pub(super) fn forget_owner(&self, map: &MapId) {
        self.owners.invalidate(map);
    }

    /// Returns the servers that are there.
    pub(super) fn nodes(&self) -> Arc<[Node]> {
        self.nodes.read().unwrap_or_else(PoisonError::into_inner).clone()
    }

    pub(super) fn set_nodes(&self, nodes: Vec<Node>) {
        *self.nodes.write().unwrap_or_else(PoisonError::into_inner) = nodes.into();
    }

    /// Returns the server that should have a map.
    pub(super) fn placed(&self, map: &MapId) -> Node {
        placed(&self.nodes(), map).unwrap_or(&self.this).clone()
    }

    /// Whether it is this server that should have a map.
    pub(in crate::engine) fn should_have(&self, map: &MapId) -> bool {
        self.placed(map).id == self.this.id
    }

    /// Whether it is this server that should have a map once another one is gone.
    pub(super) fn takes_after(&self, map: &MapId, gone: &Node) -> bool {
        let left: Vec<Node> = self.nodes().iter().filter(|node| node.id != gone.id).cloned().collect();
        placed(&left, map).is_some_and(|node| node.id == self.this.id)
    }

    /// Returns the server of an id, if it is there.
    pub(super) fn node(&self, id: &str) -> Option<Node> {
        self.nodes().iter().find(|node| node.id == id).cloned()
    }
}
