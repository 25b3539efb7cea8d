//! What happened in a map, for those who listen.

use tokio::sync::watch;

use super::{PinnedMap, QueryAnswer, Service, ServiceError};
use crate::model::event::{Event, EventKind};
use crate::model::ids::{KeyframeId, MapId};

impl Service {
    /// Returns the events after one, in their order.
    pub async fn events(
        &self,
        map: &PinnedMap,
        since: u64,
        limit: usize,
    ) -> Result<Vec<Event>, ServiceError> {
        let live = self.live_pinned(map).await?;
        Ok(self.store.events(live.key, since, limit).await?)
    }

    /// Returns the map that has this name now, and the number of its latest event as it grows. Refuses to resume after an
    /// event that is not the map's, or that has none of its successors left: the client would miss some and not know.
    ///
    /// The numbers of a map that is made after a deleted one begin above those of the deleted one. So a number from before
    /// is too small for every event that is kept, or it was not given yet.
    pub async fn resume_events(
        &self,
        map: &MapId,
        since: u64,
    ) -> Result<(PinnedMap, watch::Receiver<u64>), ServiceError> {
        let live = self.live(map).await?;
        let pinned = PinnedMap::of(&live);
        let latest = live.latest_event();
        // 0 is before the first, whichever that is.
        if since > 0 {
            let newest = *latest.borrow();
            let oldest = self.store.oldest_event(live.key).await?.unwrap_or(newest + 1);
            if since > newest || since.saturating_add(1) < oldest {
                return Err(ServiceError::Gone {
                    detail: format!(
                        "map {map} has no event {since}: it was deleted and made again, or the event is too old to be \
                         kept; read the map anew and listen with since=0"
                    ),
                });
            }
        }
        Ok((pinned, latest))
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
