//! Eviction: a map that has left memory still gets what its anchors lack, and no client has to ask for it.

use serde_json::{Value, json};

use super::scene::{crop, describes, hear, keyframe, put};
use super::stub::{Asked, Reply, Stub};
use crate::support::Server;

const MAPS: [&str; 3] = ["a", "b", "c"];
/// More than the worker looks up at once.
const CROPS: u8 = 40;

#[tokio::test(flavor = "multi_thread")]
async fn anchors_are_described_in_maps_that_have_no_room_in_memory() {
    let folder = tempfile::tempdir().unwrap();
    let server = Server::with_map_memory(folder.path(), u64::MAX).await;
    let crops: Vec<Value> =
        (0..CROPS).map(|n| crop("door_number", [f64::from(n) * 50.0, 0.0, 2.0], [n, 0, 0])).collect();
    for map in MAPS {
        server.put(&format!("/v1/maps/{map}"), &json!({})).await.expect(201);
        put(&server, map, "kf-1", &keyframe(1, 0.0, &crops)).await;
    }
    server.stop().await;

    let stub = Stub::start(|_: &Asked| Reply::Say("901".to_owned())).await;
    let server = Server::with_models_and_map_memory(folder.path(), stub.choice(&[]), 1).await;
    for map in MAPS {
        for anchor in 0..CROPS {
            hear(&server, map, describes(&format!("a-{anchor}"))).await;
        }
    }
    assert!(server.figure("revisit_map_evictions").await > 0, "they take turns in memory as well");
    // And what comes later, by turns.
    let later = keyframe(2, -500.0, &[crop("door_number", [-500.0, 0.0, 2.0], [0, 0, 250])]);
    for map in MAPS {
        put(&server, map, "kf-2", &later).await;
    }
    for map in MAPS {
        hear(&server, map, describes(&format!("a-{CROPS}"))).await;
    }
    server.stop().await;
}
