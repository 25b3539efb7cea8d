//! Membership: this server's row among the others, and the renewal of its leases.

use std::sync::{Arc, PoisonError, RwLock};
use std::time::Duration;

use rand::TryRng as _;
use rand::rngs::SysRng;

use super::placement::placed;
use crate::domain::ids::MapId;
use crate::engine::{Service, ServiceError};
use crate::store::Node;

/// The time between two renewals: a lease of ten seconds outlives two that fail.
const RENEWED_EVERY: Duration = Duration::from_secs(3);

/// This server among those that share its database.
#[derive(Debug)]
pub(in crate::engine) struct Membership {
    /// This server.
    pub(super) this: Node,
    /// The servers that are there, this one among them, as of the last renewal.
    nodes: RwLock<Arc<[Node]>>,
}

impl Membership {
    /// Returns the servers that are there.
    pub(super) fn nodes(&self) -> Arc<[Node]> {
        self.nodes.read().unwrap_or_else(PoisonError::into_inner).clone()
    }

    fn set_nodes(&self, nodes: Vec<Node>) {
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

impl Service {
    /// Takes this server's place among those that share its database, where they do: from now on it has the maps that should be
    /// its own, and others reach it at this address (`http://HOST:PORT`).
    pub async fn join(&self, address: String) -> Result<(), ServiceError> {
        let Some(leases) = self.store.leases() else { return Ok(()) };
        let mut secret = [0; 16];
        SysRng.try_fill_bytes(&mut secret).map_err(|error| ServiceError::Internal(error.to_string()))?;
        let secret = secret.iter().map(|byte| format!("{byte:02x}")).collect();
        let this = Node { id: leases.node().to_owned(), address, secret };
        let nodes = self.store.renew(&this).await?;
        tracing::info!(
            node = this.id,
            address = this.address,
            nodes = nodes.len(),
            "joined the servers of this database"
        );
        let membership = Arc::new(Membership { this, nodes: RwLock::new(nodes.into()) });
        if self.membership.set(membership.clone()).is_err() {
            return Err(ServiceError::Internal("a server joins once".to_owned()));
        }
        let (service, closing) = (self.clone(), self.closing.clone());
        tokio::spawn(closing.run_until_cancelled_owned(async move {
            loop {
                tokio::time::sleep(RENEWED_EVERY).await;
                match service.store.renew(&membership.this).await {
                    Ok(nodes) => membership.set_nodes(nodes),
                    Err(error) => tracing::warn!(%error, "leases were not renewed"),
                }
                service.hand_maps_over(&membership).await;
            }
        }));
        Ok(())
    }

    /// Gives its maps back to the other servers, once nothing is under way.
    pub(in crate::engine) async fn leave(&self) {
        if self.store.leases().is_none() {
            return;
        }
        self.store.committer().settled().await;
        if let Err(error) = self.store.leave().await {
            tracing::warn!(%error, "the maps were not given back: others take them when their leases end");
        }
    }
}
