//! Rounds of the worker, one at a time: what was written is looked at, also when its map has left memory meanwhile.

use std::sync::Arc;

use futures_util::future::BoxFuture;
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
use crate::llm::port::{Fault, Model, Question, Reply};

/// A model for images that never answers.
#[derive(Debug)]
struct Silent;

impl Model for Silent {
    fn name(&self) -> &'static str {
        "silent"
    }

    fn identity(&self) -> String {
        "silent".to_owned()
    }

    fn can(&self, question: &Question) -> bool {
        question.needs_eyes()
    }

    fn answer<'a>(&'a self, _: &'a Question) -> BoxFuture<'a, Result<Reply, Fault>> {
        Box::pin(std::future::pending())
    }
}

/// A service that keeps no idle map in memory, and a round of its worker that goes on when the test says so.
async fn paused_worker(folder: &tempfile::TempDir) -> (Service, Round) {
    let database = format!("sqlite://{}", folder.path().join("test.db").display());
    let options = ServiceOptions { map_memory: 1, ..ServiceOptions::for_tests(database) };
    let service = Service::open(options).await.unwrap();
    let args = ModelArgs::of(&[""; 0]).unwrap();
    let models = Models::with([None, Some(Arc::new(Silent))], None, &args, &service.store).await.unwrap();
    let models = Arc::new(models);
    let service = Service(Arc::new(Parts { models: Some(models.clone()), ..Parts::clone(&service) }));
    let round = Round::new(service.clone(), models);
    (service, round)
}

fn with_a_crop(name: &str) -> NewKeyframe {
    let pose = Pose::new([0.0; 3], [0.0, 0.0, 0.0, 1.0]).unwrap();
    let crop = Crop { media_type: "image/png", bytes: b"\x89PNG\r\n\x1a\n".to_vec() };
    let detection = Detection {
        class: "door_number".to_owned(),
        confidence: 0.9,
        box_px: [1.0, 2.0, 30.0, 40.0],
        map_points: Vec::new(),
        position_in_session: Some(Point3::new(0.0, 0.0, 2.0)),
        range_assumed: false,
        text: None,
        description: None,
        crop: Some(crop),
    };
    let keyframe = NewKeyframe::at(name.parse().unwrap(), Stamp { sec: 0, nanosec: 0 }, pose);
    NewKeyframe { session: "robot".parse().unwrap(), detections: vec![detection], ..keyframe }
}

/// Writes to a map that has no work until then, and waits until it has left memory.
async fn write_and_evict(service: &Service, map: &MapId) {
    service.put_keyframe(map, with_a_crop("kf"), [0; 32].into()).await.unwrap();
    while service.registry.in_memory_now(map).is_some() {
        service.registry.keep_to_budget();
        tokio::task::yield_now().await;
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn a_map_that_is_evicted_before_the_next_round_is_looked_at() {
    let folder = tempfile::tempdir().unwrap();
    let (service, mut round) = paused_worker(&folder).await;
    let map: MapId = "m".parse().unwrap();
    service.put_map(map.clone(), MapProperties::default(), None).await.unwrap();
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
    let (service, mut round) = paused_worker(&folder).await;
    let map: MapId = "m".parse().unwrap();
    service.put_map(map.clone(), MapProperties::default(), None).await.unwrap();
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
