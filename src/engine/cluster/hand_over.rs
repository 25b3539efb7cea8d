//! Hand-over: a map that another server should have goes there, after one joined or came back.

use std::sync::Arc;

use tokio::runtime::Handle;

use super::membership::Membership;
use crate::engine::maps::live::LiveMap;
use crate::engine::tasks::blocking;
use crate::engine::{Result, Service};

/// Maps that go at each renewal: each is loaded anew where it goes.
const AT_ONCE: usize = 8;

impl Service {
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
