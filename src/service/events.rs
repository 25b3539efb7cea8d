//! What happened in a map, for those who listen.

use tokio::sync::watch;

use super::{QueryAnswer, Service, ServiceError};
use crate::model::event::{Event, EventKind};
use crate::model::ids::{KeyframeId, MapId};
use crate::model::request::{LoopQuery, Subject};
use crate::model::verdict::{Decision, Verify};

impl Service {
    /// The events after one, in their order.
    pub async fn events(&self, map: &MapId, since: u64, limit: usize) -> Result<Vec<Event>, ServiceError> {
        let live = self.live(map).await?;
        Ok(self.store.events(live.key, since, limit).await?)
    }

    /// The number of the latest event; the receiver hears when it grows.
    pub async fn latest_event(&self, map: &MapId) -> Result<watch::Receiver<u64>, ServiceError> {
        Ok(self.live(map).await?.latest_event())
    }

    /// Asks in the background whether a keyframe that has just shown an anchor seen before is a loop, and tells
    /// those who listen if it is: the trigger of §III. When many wait already, this one is passed over; the
    /// client that wants to know asks.
    pub fn trigger_loop_check(&self, map: &MapId, keyframe: &KeyframeId) {
        let Ok(permit) = self.triggers.clone().try_acquire_owned() else { return };
        let (service, map, keyframe) = (self.clone(), map.clone(), keyframe.clone());
        tokio::spawn(async move {
            let _permit = permit;
            let subject = Subject::Stored(keyframe.clone());
            let query = LoopQuery { subject, verify: Verify::default(), max_wait_ms: 0, seed: 0 };
            match service.loop_query(&map, query).await {
                Ok(answer) if answer.verdict.decision == Decision::Loop => {
                    service.announce_loop(&map, &keyframe, &answer);
                }
                // The keyframe or its map may be gone already.
                Ok(_) | Err(_) => {}
            }
        });
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
