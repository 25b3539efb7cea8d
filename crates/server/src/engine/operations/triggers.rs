//! The trigger of §III: a keyframe that shows an anchor seen before is checked for a loop, even if no client asks.

use std::sync::Arc;

use crate::domain::ids::{KeyframeId, MapId};
use crate::engine::Service;
use crate::engine::limits::shared_turns::for_key;

impl Service {
    /// Starts the checks of queued triggers in the background, until the service closes.
    pub(in crate::engine) fn start_triggers(&self) {
        // Not the service itself, which would then never be dropped without being closed.
        let (parts, triggers) = (Arc::downgrade(&self.0), self.triggers.clone());
        tokio::spawn(self.closing.clone().run_until_cancelled_owned(async move {
            let mut queued = triggers.queued().await;
            while let Some((map, keyframe)) = queued.recv().await {
                let Some(parts) = parts.upgrade() else { return };
                Self(parts).trigger_loop_check(&map, &keyframe);
            }
        }));
    }

    /// Queues the checks of keyframes that, as a model answer shows, see an anchor seen before.
    pub(in crate::engine) fn trigger(&self, map: &MapId, keyframes: Vec<KeyframeId>) {
        for keyframe in keyframes {
            self.triggers.offer((map.clone(), keyframe));
        }
    }

    /// Checks a keyframe in the background, records the verdict, and announces a loop. Dropped under load, first of all work.
    pub(in crate::engine) fn trigger_loop_check(&self, map: &MapId, keyframe: &KeyframeId) {
        if self.pressure.is_high() {
            return;
        }
        let Some(slot) = self.triggers.slot() else { return };
        let (service, map, keyframe) = (self.clone(), map.clone(), keyframe.clone());
        tokio::spawn(async move {
            let _slot = slot;
            // The keyframe or its map may be deleted by now: then there is nothing to announce.
            let Ok(live) = service.live(&map).await else { return };
            let _ = for_key(live.owner, service.query_and_announce(&map, keyframe)).await;
        });
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use crate::domain::bow::BowVector;
    use crate::domain::event::{Event, EventKind};
    use crate::domain::ids::MapId;
    use crate::domain::keyframe::{CLIENTS_VOCABULARY, Detection, NewKeyframe, Stamp};
    use crate::domain::map::MapProperties;
    use crate::engine::{PinnedMap, Service, ServiceOptions};
    use crate::geometry::{Point3, Pose};

    /// Returns a keyframe before door 901 that shares no word with another one.
    fn before_the_door(name: &str, word: u32) -> NewKeyframe {
        let plate = Detection {
            position_in_session: Some(Point3::new(0.0, 0.0, 2.0)),
            text: Some("901".to_owned()),
            ..Detection::of("door_number", 0.9, [1.0, 2.0, 30.0, 40.0])
        };
        let stamp = Stamp { sec: i64::from(word), nanosec: 0 };
        NewKeyframe {
            bow: BowVector::normalised(vec![(word, 1.0)]).unwrap(),
            vocabulary: Some(CLIENTS_VOCABULARY.into()),
            detections: vec![plate],
            ..NewKeyframe::at(name.parse().unwrap(), stamp, Pose::identity())
        }
    }

    /// Waits for the announcement of a loop.
    async fn loop_found(service: &Service, map: &PinnedMap) -> Event {
        loop {
            let events = service.events(map, 0, 100).await.unwrap();
            if let Some(found) = events.into_iter().find(|event| event.kind == EventKind::LoopFound) {
                return found;
            }
            tokio::task::yield_now().await;
        }
    }

    #[tokio::test(flavor = "multi_thread")]
    async fn an_anchor_seen_before_announces_a_loop_without_a_server_and_without_a_question() {
        let folder = tempfile::tempdir().unwrap();
        let database = format!("sqlite://{}/test.db", folder.path().display());
        let service = Service::open(ServiceOptions::for_tests(database)).await.unwrap();
        let map: MapId = "hotel".parse().unwrap();
        let properties = MapProperties { metric: true, ..MapProperties::default() };
        service.put_map(map.clone(), properties, None).await.unwrap();
        service.put_keyframe(&map, before_the_door("kf-1", 1), [1; 32]).await.unwrap();
        service.put_keyframe(&map, before_the_door("kf-9", 60), [9; 32]).await.unwrap();
        let pinned = service.pin_map(&map).await.unwrap();
        let found = tokio::time::timeout(Duration::from_mins(1), loop_found(&service, &pinned));
        let found = found.await.expect("an announcement");
        assert_eq!(found.keyframe, Some("kf-9".parse().unwrap()));
        assert_eq!(found.candidate, Some("kf-1".parse().unwrap()));
        // The verdict that the announcement names is on record.
        let query = found.query.expect("a query");
        let recorded = service.kept_query(&map, &query).await.unwrap();
        let recorded: serde_json::Value = serde_json::from_slice(&recorded).unwrap();
        assert_eq!(recorded["id"], query);
        service.close().await;
    }
}
