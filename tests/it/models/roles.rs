//! Roles: which models are configured is part of a verdict's id, and a server without any waits for none.

use serde_json::{Value, json};

use super::scene::{crop, described, keyframe, put};
use super::stub::{Reply, Stub};
use crate::support::Server;

/// Two lobbies with one room's name on the wall, and a plate beside it that nothing has read.
async fn lobbies(server: &Server) {
    server.put("/v1/maps/m", &json!({})).await.expect(201);
    for (name, sec, x, colour) in [("kf-1", 1, 0.0, [255, 0, 0]), ("kf-2", 90, 50.0, [0, 0, 255])] {
        let name_on_wall = described("wall_sign", [x + 1.0, 0.0, 2.0], "room 901");
        let plate = crop("door_number", [x, 0.0, 1.0], colour);
        put(server, "m", name, &keyframe(sec, x, &[name_on_wall, plate])).await;
    }
}

async fn ask(server: &Server) -> Value {
    let query = json!({"keyframe": "kf-2", "max_wait_ms": 0});
    server.post("/v1/maps/m/loop-queries", &query).await.expect(200)
}

#[tokio::test(flavor = "multi_thread")]
async fn a_verdict_that_depends_on_a_vision_model_has_an_id_and_a_record_of_its_own() {
    let folder = tempfile::tempdir().unwrap();
    let server = Server::on(folder.path()).await;
    lobbies(&server).await;
    let without = ask(&server).await;
    assert_eq!(without["verdict"], "loop", "{without}");
    server.stop().await;

    // The model never answers, so that the map stays as it is.
    let stub = Stub::start(|_| Reply::Hang).await;
    let server = Server::with_models_on(folder.path(), stub.choice(&[])).await;
    let with = ask(&server).await;
    assert_eq!(with["map_version"], without["map_version"]);
    assert_eq!(
        (&with["verdict"], &with["candidates"][0]["reason"]["code"]),
        (&json!("undecided"), &json!("llm_pending")),
        "{with}"
    );
    assert_ne!(with["id"], without["id"]);
    for answer in [&without, &with] {
        let id = answer["id"].as_str().unwrap();
        assert_eq!(server.get(&format!("/v1/maps/m/loop-queries/{id}")).await.expect(200), *answer);
    }
}
