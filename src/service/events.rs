//! What happened in a map, for those who listen.

use super::{Listener, QueryAnswer, Service, ServiceError};
use crate::model::event::{Event, EventKind};
use crate::model::ids::{KeyframeId, MapId};

impl Service {
    /// The events after one, in their order.
    pub async fn events(&self, map: &MapId, since: u64, limit: usize) -> Result<Vec<Event>, ServiceError> {
        let key = self.key_of(map).await?;
        Ok(self.store.events(key, since, limit).await?)
    }

    /// Listens to the events of a map, which need not be in memory for that.
    pub async fn listen(&self, map: &MapId) -> Result<Listener, ServiceError> {
        let key = self.key_of(map).await?;
        // Where nothing is known of its events, the first that is hears of all of them.
        Ok(Listener::to(self.registry.feeds.of(key, 0)))
    }

    /// Tells that a keyframe that arrived is a loop. Written behind: the verdict can be asked for again.
    pub fn announce_loop(&self, keyframe: &KeyframeId, answer: &QueryAnswer) {
        let live = answer.map.live().clone();
        let mut event = Event::of(EventKind::LoopFound);
        event.keyframe = Some(keyframe.clone());
        event.candidate.clone_from(&answer.verdict.best);
        event.query = Some(answer.id.clone());
        let store = self.store.clone();
        // Takes the map's lock, which may be held for a while; the answer need not wait for it.
        drop(tokio::task::spawn_blocking(move || live.tell(&store, vec![event])));
    }
}
