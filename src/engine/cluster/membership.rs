//! Membership: this server among those that share its database, and what it knows of them.

use std::sync::{Arc, PoisonError, RwLock};
use std::time::{Duration, Instant};

use moka::sync::Cache;

use super::placement::placed;
use crate::domain::ids::MapId;
use crate::store::{HeardOf, Node};

/// An owner is asked for again after this time. A map that moves meanwhile is answered with 503, as while it moves.
const OWNER_LASTS: Duration = Duration::from_millis(500);

/// The most owners that are kept.
const OWNERS_MAX: u64 = 10_000;

/// A map is loaded ahead once in this time, which a lease lasts.
const AHEAD_ONCE_IN: Duration = Duration::from_secs(10);

/// A list that is older tells nothing of who is gone: this server was away from the database itself.
const LIST_LASTS: Duration = Duration::from_secs(6);

/// This server among those that share its database.
#[derive(Debug)]
pub(in crate::engine) struct Membership {
    /// This server.
    pub(super) this: Node,
    /// The servers as of the last renewal, this one among them.
    list: RwLock<Arc<List>>,
    /// The owners of maps that other servers have, as the database said a moment ago.
    owners: Cache<MapId, String>,
    /// Maps that were loaded ahead a moment ago, or were to be.
    ahead: Cache<MapId, ()>,
}

/// The servers that were there when the database told of them.
#[derive(Debug)]
struct List {
    heard_of: Vec<HeardOf>,
    told: Instant,
}

impl List {
    /// Returns the servers that are there now. One that was not heard of again counts as gone when its leases have run out.
    fn there(&self, now: Instant) -> impl Iterator<Item = &Node> {
        let age = now.saturating_duration_since(self.told);
        self.heard_of
            .iter()
            .filter(move |heard| age < heard.lasts || age > LIST_LASTS)
            .map(|heard| &heard.node)
    }
}

impl Membership {
    pub(super) fn of(this: Node, heard_of: Vec<HeardOf>) -> Arc<Self> {
        let owners = Cache::builder().max_capacity(OWNERS_MAX).time_to_live(OWNER_LASTS).build();
        let list = RwLock::new(Arc::new(List { heard_of, told: Instant::now() }));
        let ahead = Cache::builder().max_capacity(OWNERS_MAX).time_to_live(AHEAD_ONCE_IN).build();
        Arc::new(Self { this, list, owners, ahead })
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

    fn list(&self) -> Arc<List> {
        self.list.read().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Notes the servers that the database tells of now; nothing if this one is not among them, which was away and renews soon.
    pub(super) fn set_list(&self, heard_of: Vec<HeardOf>) {
        if !heard_of.iter().any(|heard| heard.node.id == self.this.id) {
            return;
        }
        let list = Arc::new(List { heard_of, told: Instant::now() });
        *self.list.write().unwrap_or_else(PoisonError::into_inner) = list;
    }

    /// Returns the number of servers that are there.
    pub(super) fn count(&self) -> usize {
        self.list().there(Instant::now()).count()
    }

    /// Returns the server that should have a map.
    pub(super) fn placed(&self, map: &MapId) -> Node {
        placed(self.list().there(Instant::now()), map).unwrap_or(&self.this).clone()
    }

    /// Whether it is this server that should have a map.
    pub(in crate::engine) fn should_have(&self, map: &MapId) -> bool {
        self.is_this(placed(self.list().there(Instant::now()), map))
    }

    /// Whether it is this server that should have a map once another one is gone.
    pub(super) fn takes_after(&self, map: &MapId, gone: &Node) -> bool {
        let list = self.list();
        self.is_this(placed(list.there(Instant::now()).filter(|node| node.id != gone.id), map))
    }

    fn is_this(&self, node: Option<&Node>) -> bool {
        node.is_none_or(|node| node.id == self.this.id)
    }

    /// Whether a map is loaded ahead by the one who asks, and not by another one a moment ago.
    pub(super) fn begins_ahead(&self, map: &MapId) -> bool {
        self.ahead.entry(map.clone()).or_insert(()).is_fresh()
    }

    /// Returns the server of an id, if it is there.
    pub(super) fn node(&self, id: &str) -> Option<Node> {
        self.list().there(Instant::now()).find(|node| node.id == id).cloned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_server_that_is_not_heard_of_again_is_gone_with_its_leases_unless_nobody_was() {
        let heard = |id: &str, lasts| HeardOf {
            node: Node { id: id.to_owned(), address: String::new(), secret: String::new() },
            lasts: Duration::from_secs(lasts),
        };
        let list = List { heard_of: vec![heard("this", 10), heard("silent", 2)], told: Instant::now() };
        let there = |after| -> Vec<&str> {
            list.there(list.told + Duration::from_secs(after)).map(|node| node.id.as_str()).collect()
        };
        assert_eq!(there(1), ["this", "silent"]);
        assert_eq!(there(3), ["this"]);
        // The database did not answer since: nobody was heard of.
        assert_eq!(there(20), ["this", "silent"]);
    }
}
