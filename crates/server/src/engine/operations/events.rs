//! What happened in a map, for those who listen.

use std::sync::Arc;

use crate::domain::event::{Event, EventKind};
use crate::domain::ids::MapId;
use crate::engine::maps::live::LiveMap;
use crate::engine::{Listener, PinnedMap, QueryAnswer, Result, Service, ServiceError};
use crate::store::StoreError;

impl Service {
    /// Returns the events after one, in their order.
    pub async fn events(&self, map: &PinnedMap, since: u64, limit: usize) -> Result<Vec<Event>> {
        let key = self.key_of_pinned(map).await?;
        let found = self.store.events(key, since, limit).await;
        // A stream has begun to answer and can only end: the log says why.
        if let Err(error @ StoreError::Damaged { .. }) = &found {
            tracing::error!(map = %map.id, %error, "events cannot be read");
        }
        Ok(found?)
    }

    /// Listens to the events of the map that has this name now, which need not be in memory for that. Refuses to resume
    /// after an event that is not the map's, or that has none of its successors left: the client would miss some
    /// and not know.
    ///
    /// The numbers of a map that is made after a deleted one begin above those of the deleted one. So a number from before
    /// is too small for every event that is kept, or it was not given yet.
    pub async fn resume_events(&self, map: &MapId, since: u64) -> Result<(PinnedMap, Listener)> {
        let pinned = self.pin_map(map).await?;
        // Where nothing is known of its events, the first that is hears of all of them.
        let listener = Listener::to(self.registry.feeds.of(pinned.key, 0));
        // 0 is before the first, whichever that is.
        if since > 0 {
            let kept = self.store.kept_events(pinned.key).await?.ok_or_else(|| ServiceError::no_map(map))?;
            if since >= kept.end || since.saturating_add(1) < kept.start {
                return Err(ServiceError::Gone(format!(
                    "map {map} has no event {since}: it was deleted and made again, or the event is too old to be \
                         kept; read the map anew and listen with since=0"
                )));
            }
        }
        Ok((pinned, listener))
    }

    /// Announces the verdict about a keyframe that arrived. Written behind: it can be asked for again.
    pub(in crate::engine) fn announce(&self, kind: EventKind, live: &Arc<LiveMap>, answer: &QueryAnswer) {
        let mut event = Event::of(kind);
        event.keyframe.clone_from(&answer.keyframe);
        let verdict = &answer.verdict;
        let likeliest = || verdict.candidates.first().map(|candidate| candidate.keyframe.clone());
        event.candidate = verdict.best.clone().or_else(likeliest);
        event.query = Some(answer.id.clone());
        event.detail = (kind == EventKind::LoopRejected).then(|| verdict.why.clone());
        let (live, store) = (live.clone(), self.store.clone());
        // Takes the map's lock, which may be held for a while; the answer need not wait for it.
        drop(tokio::task::spawn_blocking(move || live.tell(&store, vec![event])));
    }
}
