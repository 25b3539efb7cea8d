//! Membership: this server among those that share its database, and what it knows of them.

use std::sync::{Arc, PoisonError, RwLock};
use std::time::{Duration, Instant};

use moka::sync::Cache;

use super::placement::placed;
use crate::domain::ids::MapId;
use crate::store::{LiveNode, Node, Store};

/// An owner is asked for again after this time. A map that moves meanwhile is answered with 503, as while it moves.
const OWNER_LASTS: Duration = Duration::from_millis(500);

/// The most owners that are kept.
const OWNERS_MAX: u64 = 10_000;

/// A map is loaded ahead once in this time, which a lease lasts.
const AHEAD_ONCE_IN: Duration = Duration::from_secs(10);

/// Maximum age at which a list shows that a server is gone. An older one means that this server was away from the database itself.
const LIST_LASTS: Duration = Duration::from_secs(6);

/// A list that is younger is not read anew.
const LIST_FRESH: Duration = Duration::from_millis(300);

/// This server among those that share its database.
#[derive(Debug)]
pub(in crate::engine) struct Membership {
    /// This server.
    pub(super) this: Node,
    /// The servers as of the last renewal, this one among them.
    list: RwLock<Arc<List>>,
    /// The owners of maps that other servers have, as the database said a moment ago.
    pub(super) owners: Cache<MapId, String>,
    /// Maps that were loaded ahead a moment ago, or were to be.
    ahead: Cache<MapId, ()>,
    /// Held by the one who reads the list anew.
    reading: tokio::sync::Mutex<()>,
}

/// The servers that were there when the database was asked.
#[derive(Debug)]
struct List {
    nodes: Vec<LiveNode>,
    asked: Instant,
}

impl List {
    /// Returns the servers that are there now, `this` one always. Another one whose renewal was not seen counts as gone when its leases
    /// have run out.
    fn there(&self, this: &Node, now: Instant) -> impl Iterator<Item = &Node> {
        let age = now.saturating_duration_since(self.asked);
        let is_there =
            move |live: &&LiveNode| age < live.lasts || age > LIST_LASTS || live.node.id == this.id;
        self.nodes.iter().filter(is_there).map(|live| &live.node)
    }
}

impl Membership {
    pub(super) fn of(this: Node, asked: Instant, nodes: Vec<LiveNode>) -> Arc<Self> {
        let owners = Cache::builder().max_capacity(OWNERS_MAX).time_to_live(OWNER_LASTS).build();
        let list = RwLock::new(Arc::new(List { nodes, asked }));
        let ahead = Cache::builder().max_capacity(OWNERS_MAX).time_to_live(AHEAD_ONCE_IN).build();
        Arc::new(Self { this, list, owners, ahead, reading: tokio::sync::Mutex::default() })
    }

    /// Returns the owner of a map that another server had a moment ago.
    pub(super) fn owner_before(&self, map: &MapId) -> Option<Node> {
        self.node(&self.owners.get(map)?)
    }

    fn list(&self) -> Arc<List> {
        self.list.read().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Replaces the list, unless it was asked for later, or this server is missing from the new one: its next renewal adds it.
    pub(super) fn set_list(&self, asked: Instant, nodes: Vec<LiveNode>) {
        let mut list = self.list.write().unwrap_or_else(PoisonError::into_inner);
        if asked > list.asked && nodes.iter().any(|live| live.node.id == self.this.id) {
            if self.shares_its_address(&nodes) && !self.shares_its_address(&list.nodes) {
                let address = &self.this.address;
                tracing::warn!(%address, "another server is at this address, too: give each its own --advertise");
            }
            *list = Arc::new(List { nodes, asked });
        }
    }

    fn shares_its_address(&self, nodes: &[LiveNode]) -> bool {
        let is_other =
            |live: &LiveNode| live.node.id != self.this.id && live.node.address == self.this.address;
        nodes.iter().any(is_other)
    }

    /// Reads the list anew, unless that was done a moment ago or somebody does it now: between two renewals servers come and go.
    pub(in crate::engine) async fn read_list(&self, store: &Store) {
        let Ok(_reading) = self.reading.try_lock() else { return };
        if self.list().asked.elapsed() < LIST_FRESH {
            return;
        }
        let asked = Instant::now();
        match store.live_nodes().await {
            Ok(nodes) => self.set_list(asked, nodes),
            // The known list is good enough.
            Err(error) => tracing::debug!(%error, "the list of servers was not read"),
        }
    }

    /// Returns the number of servers that are there.
    pub(super) fn count(&self) -> usize {
        self.list().there(&self.this, Instant::now()).count()
    }

    /// Returns the server that should have a map.
    pub(super) fn placed(&self, map: &MapId) -> Node {
        placed(self.list().there(&self.this, Instant::now()), map).unwrap_or(&self.this).clone()
    }

    /// Whether it is this server that should have a map.
    pub(in crate::engine) fn should_have(&self, map: &MapId) -> bool {
        self.placed(map).id == self.this.id
    }

    /// Whether it is this server that should have a map once another one is gone.
    pub(super) fn takes_after(&self, map: &MapId, gone: &Node) -> bool {
        let list = self.list();
        let left = list.there(&self.this, Instant::now()).filter(|node| node.id != gone.id);
        placed(left, map).is_none_or(|node| node.id == self.this.id)
    }

    /// Whether no load of this map was begun ahead within the last ten seconds. Notes this one.
    pub(super) fn try_begin_ahead(&self, map: &MapId) -> bool {
        self.ahead.entry(map.clone()).or_insert(()).is_fresh()
    }

    /// Returns the server of an id, if it is there.
    pub(super) fn node(&self, id: &str) -> Option<Node> {
        self.list().there(&self.this, Instant::now()).find(|node| node.id == id).cloned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_server_whose_renewal_is_not_seen_is_gone_with_its_leases_unless_no_renewal_is() {
        let live = |id: &str, lasts| LiveNode {
            node: Node { id: id.to_owned(), address: String::new(), secret: String::new() },
            lasts: Duration::from_secs(lasts),
        };
        let list = List { nodes: vec![live("this", 2), live("silent", 2)], asked: Instant::now() };
        let this = live("this", 0).node;
        let there = |after| -> Vec<&str> {
            let nodes = list.there(&this, list.asked + Duration::from_secs(after));
            nodes.map(|node| node.id.as_str()).collect()
        };
        assert_eq!(there(1), ["this", "silent"]);
        assert_eq!(there(3), ["this"]);
        // The database did not answer since: nobody's renewal was seen.
        assert_eq!(there(20), ["this", "silent"]);
    }
}
