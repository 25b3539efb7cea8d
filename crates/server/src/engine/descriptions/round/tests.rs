//! Rounds of the worker, one at a time: what was written is looked at, also when its map has left memory meanwhile.

use std::sync::Arc;

use sqlx::sqlite::SqliteConnectOptions;
use sqlx::{ConnectOptions as _, Executor as _};

use super::Round;
use crate::config::models::ModelArgs;
use crate::domain::ids::MapId;
use crate::domain::keyframe::{Crop, Detection, NewKeyframe, Stamp};
use crate::domain::map::MapProperties;
use crate::engine::service::Parts;
use crate::engine::{Service, ServiceOptions};
use crate::geometry::{Point3, Pose};
use crate::llm::Models;
use crate::llm::port::Model;
use crate::llm::silent::Silent;

/// Returns a service that keeps no idle map in memory, a map of it, and a round of its worker that runs when the test
/// calls it.
async fn paused_worker(folder: &tempfile::TempDir) -> (Service, MapId, Round) {
    let database = format!("sqlite://{}", folder.path().join("test.db").display());
    let options = ServiceOptions { map_memory: 1, ..ServiceOptions::for_tests(database) };
    let service = Service::open(options).await.unwrap();
    let args = ModelArgs::of(&[""; 0]).unwrap();
    let found: [Option<Arc<dyn Model>>; 3] = [None, Some(Arc::new(Silent { sees: true })), None];
    let models = Models::with(found, None, &args, &service.store).await.unwrap();
    let models = Arc::new(models);
    let service = Service(Arc::new(Parts { models: Some(models.clone()), ..Parts::clone(&service) }));
    let map: MapId = "m".parse().unwrap();
    service.put_map(map.clone(), MapProperties::default(), None).await.unwrap();
    let round = Round::new(service.clone(), models);
    (service, map, round)
}

fn with_a_crop(name: &str) -> NewKeyframe {
    let crop = Crop { media_type: "image/png", bytes: b"\x89PNG\r\n\x1a\n".to_vec() };
    let detection = Detection {
        position_in_session: Some(Point3::new(0.0, 0.0, 2.0)),
        crop: Some(crop),
        ..Detection::of("door_number", 0.9, [1.0, 2.0, 30.0, 40.0])
    };
    let keyframe = NewKeyframe::at(name.parse().unwrap(), Stamp { sec: 0, nanosec: 0 }, Pose::identity());
    NewKeyframe { detections: vec![detection], ..keyframe }
}

/// Writes to a map that has no work until then, and waits until it has left memory.
async fn write_and_evict(service: &Service, map: &MapId) {
    service.put_keyframe(map, with_a_crop("kf"), [0; 32]).await.unwrap();
    while service.registry.in_memory_now(map).is_some() {
        service.registry.keep_to_budget();
        tokio::task::yield_now().await;
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn a_map_that_is_evicted_before_the_next_round_is_looked_at() {
    let folder = tempfile::tempdir().unwrap();
    let (service, map, mut round) = paused_worker(&folder).await;
    round.list_unexamined().await;
    round.hand_out().await;
    write_and_evict(&service, &map).await;
    let next = round.hand_out().await;
    assert!(next.is_some(), "what was found is handed out at once");
    round.hand_out().await;
    assert_eq!(round.jobs.len(), 1);
    round.jobs.abort_all();
    service.close().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_map_that_cannot_be_loaded_is_looked_at_again_after_a_rest() {
    let folder = tempfile::tempdir().unwrap();
    let (service, map, mut round) = paused_worker(&folder).await;
    write_and_evict(&service, &map).await;

    let file = folder.path().join("test.db");
    let mut broken = SqliteConnectOptions::new().filename(file).connect().await.unwrap();
    broken.execute("alter table anchors rename to elsewhere").await.unwrap();
    round.hand_out().await;
    let now = tokio::time::Instant::now();
    let again = round.unexamined.next_due(now).expect("it is not forgotten");
    assert!(again > now, "it rests");
    assert!(round.unexamined.take(now).is_none());

    broken.execute("alter table elsewhere rename to anchors").await.unwrap();
    tokio::time::sleep_until(again).await;
    round.hand_out().await;
    round.hand_out().await;
    assert_eq!(round.jobs.len(), 1);
    round.jobs.abort_all();
    service.close().await;
}
