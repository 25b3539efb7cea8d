//! Routing: where a request about a map is answered.

use std::time::Duration;

use tokio::time::timeout;

use super::membership::Membership;
use crate::domain::ids::MapId;
use crate::engine::{Result, Service, ServiceError};
use crate::store::{Lease, Node, Owner};

/// The longest wait for the database to say who owns a map that is in memory.
const OWNER_LOOKUP_TIMEOUT: Duration = Duration::from_secs(1);

/// The server that answers a request.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Route {
    /// By this server.
    Here,
    /// By another one.
    At(Node),
}

impl Service {
    /// Returns where a request about a map is answered.
    pub async fn route(&self, map: &MapId) -> Result<Route> {
        let Some(membership) = self.membership.get() else { return Ok(Route::Here) };
        if let Some(live) = self.registry.in_memory_now(map) {
            if live.lease().is_none_or(Lease::is_valid) {
                return Ok(Route::Here);
            }
            // Another server may have it by now, though this one has not noticed. If the database does not say, it is refused here.
            drop(live);
            let (service, membership, map) = (self.clone(), membership.clone(), map.clone());
            // In a task of its own: a question that is broken off closes its connection.
            let asking = tokio::spawn(async move { service.route_by_owner(&membership, &map).await });
            return match timeout(OWNER_LOOKUP_TIMEOUT, asking).await {
                Ok(told) => told.map_err(ServiceError::panicked)?,
                Err(_) => Ok(Route::Here),
            };
        }
        self.route_by_owner(membership, map).await
    }

    async fn route_by_owner(&self, membership: &Membership, map: &MapId) -> Result<Route> {
        if let Some(node) = membership.owner_before(map) {
            return Ok(Route::At(node));
        }
        match self.store.owner(map).await? {
            Some(Owner::Other(id, node)) => {
                membership.owners.insert(map.clone(), id.clone());
                // One that came since the last renewal, or came back.
                membership.node(&id).or(node).map(Route::At).ok_or_else(|| {
                    let detail = "the server that has this map is not heard of; another one takes it soon";
                    ServiceError::unavailable(detail.to_owned())
                })
            }
            // One that is to be made is made where it should be.
            Some(Owner::Free) | None => {
                if !membership.should_have(map) {
                    // A server that left since the last renewal would be asked in vain.
                    membership.read_list(&self.store).await;
                }
                let node = membership.placed(map);
                Ok(if node.id == membership.this.id { Route::Here } else { Route::At(node) })
            }
        }
    }

    /// Whether work on a map is this server's, as far as it can tell now.
    pub(in crate::engine) async fn is_here(&self, map: &MapId) -> bool {
        matches!(self.route(map).await, Ok(Route::Here))
    }

    /// Notes that the server that has a map did not answer, or has it no more.
    pub fn ask_for_owner_again(&self, map: &MapId) {
        if let Some(membership) = self.membership.get() {
            membership.owners.invalidate(map);
        }
    }

    /// Whether a request comes from another of the servers, which knows this one's secret.
    pub fn is_from_peer(&self, secret: &[u8]) -> bool {
        self.membership.get().is_some_and(|membership| membership.this.secret.as_bytes() == secret)
    }

    /// Returns the number of servers that share the database; 0 where one alone has it.
    pub fn node_count(&self) -> u64 {
        self.membership.get().map_or(0, |membership| membership.count() as u64)
    }

    /// Returns the address at which the others reach this server, where there may be others.
    pub fn address(&self) -> Option<&str> {
        self.membership.get().map(|membership| membership.this.address.as_str())
    }
}
