//! Joining and leaving: this server's row among those that share its database, the renewal of its leases, and the maps that go to
//! the server that should have them, after one joined or came back.

use std::sync::Arc;
use std::time::{Duration, Instant};

use tokio::runtime::Handle;

use super::membership::Membership;
use crate::engine::maps::live::LiveMap;
use crate::engine::tasks::blocking;
use crate::engine::{Result, Service, ServiceError};
use crate::store::Node;

/// The time between two renewals: a lease of ten seconds outlives two that fail.
const RENEWED_EVERY: Duration = Duration::from_secs(3);

/// Maps that go at each renewal: each is loaded anew where it goes.
const AT_ONCE: usize = 8;

impl Service {
    /// Takes this server's place among those that share its database, where they do: from now on it has the maps that should be
    /// its own, and others reach it at this address (`http://HOST:PORT`).
    pub async fn join(&self, address: String) -> Result<()> {
        let Some(leases) = self.store.leases() else { return Ok(()) };
        let this = Node::new(leases.node(), address);
        self.store.succeed(&this).await?;
        let asked = Instant::now();
        let nodes = self.store.renew(&this).await?;
        tracing::info!(
            node = this.id,
            address = this.address,
            nodes = nodes.len(),
            "joined the servers of this database"
        );
        let membership = Membership::of(this, asked, nodes);
        if self.membership.set(membership.clone()).is_err() {
            return Err(ServiceError::Internal("a server joins once".to_owned()));
        }
        let (service, closing) = (self.clone(), self.closing.clone());
        let renewed = membership.clone();
        tokio::spawn(closing.run_until_cancelled_owned(async move {
            loop {
                tokio::time::sleep(RENEWED_EVERY).await;
                let asked = Instant::now();
                match service.store.renew(&renewed.this).await {
                    Ok(nodes) => renewed.set_list(asked, nodes),
                    Err(error) => tracing::warn!(%error, "leases were not renewed"),
                }
            }
        }));
        self.tend_in_background(membership);
        self.keep_up_in_background();
        Ok(())
    }

    /// Lets maps go, takes on what other servers left behind, and keeps what followers answered. Beside the renewals, which wait for
    /// nothing else: a lease that is not renewed in time is lost.
    fn tend_in_background(&self, membership: Arc<Membership>) {
        let (service, closing) = (self.clone(), self.closing.clone());
        tokio::spawn(closing.run_until_cancelled_owned(async move {
            loop {
                tokio::time::sleep(RENEWED_EVERY).await;
                service.hand_maps_over(&membership).await;
                service.rejudging.wake();
                if let Err(error) = service.take_erasures_on().await {
                    tracing::debug!(%error, "erasures were not looked for");
                }
                if let Err(error) = service.keep_answers_of_followers().await {
                    tracing::debug!(%error, "answers of followers were not kept");
                }
            }
        }));
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

    /// Lets some maps go that another server should have, and those whose lease is lost.
    pub(super) async fn hand_maps_over(&self, membership: &Membership) {
        let mut going = self.registry.in_memory(|live| live.is_over() || !membership.should_have(&live.id));
        for over in going.extract_if(.., |live| live.is_over()) {
            self.registry.forget_over(&over.id);
        }
        for live in going.into_iter().take(AT_ONCE) {
            let id = live.id.clone();
            match self.hand_over(live).await {
                Ok(()) => tracing::info!(map = %id, "a map goes to the server that should have it"),
                Err(error) => tracing::debug!(map = %id, %error, "a map was not handed over"),
            }
        }
    }

    /// Lets a map go, once all that was decided is on disk. Nobody reads it from memory when the lease is given back.
    async fn hand_over(&self, live: Arc<LiveMap>) -> Result<()> {
        let _lane = live.lane.lock().await;
        let (store, runtime, leaving) = (self.store.clone(), Handle::current(), live.clone());
        blocking(move || leaving.leave_memory(&store, &runtime)).await??;
        self.registry.forget_over(&live.id);
        if let Some(lease) = live.lease() {
            self.store.give_back(lease).await?;
        }
        Ok(())
    }
}
