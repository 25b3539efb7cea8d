//! Membership: this server among those that share its database, and what it knows of them.

use std::sync::{Arc, PoisonError, RwLock};

use super::placement::placed;
use crate::domain::ids::MapId;
use crate::store::Node;

/// This server among those that share its database.
#[derive(Debug)]
pub(in crate::engine) struct Membership {
    /// This server.
    pub(super) this: Node,
    /// The servers that are there, this one among them, as of the last renewal.
    nodes: RwLock<Arc<[Node]>>,
}

impl Membership {
    pub(super) fn of(this: Node, nodes: Vec<Node>) -> Arc<Self> {
        Arc::new(Self { this, nodes: RwLock::new(nodes.into()) })
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

    /// Returns the server of an id, if it is there.
    pub(super) fn node(&self, id: &str) -> Option<Node> {
        self.nodes().iter().find(|node| node.id == id).cloned()
    }
}
