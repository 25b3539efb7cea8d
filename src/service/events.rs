//! What happened in a map, for those who listen.

use tokio::sync::watch;

use super::{QueryAnswer, Service, ServiceError};
use crate::model::event::{Event, EventKind};
use crate::model::ids::{KeyframeId, MapId};
use crate::store::StoreError;

impl Service {
    /// The events after one, in their order.
    pub async fn events(&self, map: &MapId, since: u64, limit: usize) -> Result<Vec<Event>, ServiceError> {
        let live = self.live(map).await?;
        let found = self.store.events(live.key, since, limit).await;
        // A stream has begun to answer and can only end: the log says why.
        if let Err(error @ StoreError::Damaged { .. }) = &found {
            tracing::error!(%map, %error, "events cannot be read");
        }
        Ok(found?)
    }

    /// The number of the latest event; the receiver hears when it grows.
    pub async fn latest_event(&self, map: &MapId) -> Result<watch::Receiver<u64>, ServiceError> {
        Ok(self.live(map).await?.latest_event())
    }

    /// Tells that a keyframe that arrived is a loop. Written behind: the verdict can be asked for again.
    pub fn announce_loop(&self, map: &MapId, keyframe: &KeyframeId, answer: &QueryAnswer) {
        let Some(live) = self.registry.in_memory_now(map) else { return };
        let mut event = Event::of(EventKind::LoopFound);
        event.keyframe = Some(keyframe.clone());
        event.candidate.clone_from(&answer.verdict.best);
        event.query = Some(answer.id.clone());
        let store = self.store.clone();
        // Takes the map's lock, which may be held for a while; the answer need not wait for it.
        drop(tokio::task::spawn_blocking(move || live.tell(&store, vec![event])));
    }
}
