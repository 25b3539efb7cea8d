//! Gravity and global descriptors over HTTP: what is taken, what is kept, and what the third channel proposes.

use serde_json::{Value, json};

use crate::support::{Server, keyframe};

/// Signed bytes in base64: `[100, 90, -80, 3]` and what is nearly so.
const HERE: &str = "ZFqwAw==";
const NEARLY_HERE: &str = "ZFuwAw==";
const ELSEWHERE: &str = "nKZQ/Q==";

fn with_descriptor(model: &str, encoding: &str, data: &str) -> Value {
    let mut body = keyframe();
    body["global_descriptor"] = json!({"model": model, "encoding": encoding, "data": data});
    body
}

#[tokio::test]
async fn a_map_takes_global_descriptors_of_one_model_encoding_and_size() {
    let server = Server::with_map("m").await;
    let put = async |id: &str, body: Value| server.put(&format!("/v1/maps/m/keyframes/{id}"), &body).await;
    put("a", with_descriptor("megaloc", "int8", HERE)).await.expect(201);
    let others = [("other", "int8", HERE), ("megaloc", "bits", HERE), ("megaloc", "int8", "ZFqw")];
    for (model, encoding, data) in others {
        let body = with_descriptor(model, encoding, data);
        let inline = json!({"inline": body.clone()});
        for refused in [put("b", body).await, server.post("/v1/maps/m/loop-queries", &inline).await] {
            assert_eq!(refused.body["code"], "other_global_descriptor", "{model} {encoding} {data}");
            let told = refused.expect(409)["detail"].to_string();
            assert!(told.contains("of model megaloc, int8, 4 bytes"), "{told}");
        }
    }
    put("none", keyframe()).await.expect(201);
    server.delete("/v1/maps/m/keyframes/a").await.expect(200);
    // The last of its form is gone, so another one begins.
    put("b", with_descriptor("other", "bits", HERE)).await.expect(201);
}

#[tokio::test]
async fn what_is_no_unit_vector_or_no_descriptor_is_refused_by_its_place() {
    let server = Server::with_map("m").await;
    let mut body = with_descriptor("a b", "float32", "");
    body["gravity"] = json!([0.0, 0.9, 0.0]);
    let refused = server.put("/v1/maps/m/keyframes/a", &body).await;
    let places =
        ["/gravity", "/global_descriptor/model", "/global_descriptor/encoding", "/global_descriptor/data"];
    assert_eq!(refused.pointers(), places);
    assert_eq!(refused.body["errors"][0]["got"], "a norm of 0.9");
    refused.expect(422);
    let refused = server.patch("/v1/maps/m", &json!({"gravity": [0, -9.81, 0]})).await;
    assert_eq!(refused.pointers(), ["/gravity/1"]);
}

#[tokio::test]
async fn gravity_and_descriptors_are_given_back_as_sent_and_a_retry_is_told_from_another_keyframe() {
    let folder = tempfile::tempdir().unwrap();
    let server = Server::on(folder.path()).await;
    let map = json!({"gravity": [0.0, 0.0, -1.0]});
    server.put("/v1/maps/m", &map).await.expect(201);
    assert_eq!(server.put("/v1/maps/m", &map).await.header("idempotent-replayed"), "true");
    server.put("/v1/maps/m", &json!({})).await.expect(409);
    let mut sent = with_descriptor("megaloc", "int8", HERE);
    sent["gravity"] = json!([0.0004, 1.0004, 0.0]);
    sent["height_m"] = json!(-3.25);
    let path = "/v1/maps/m/keyframes/here";
    server.put(path, &sent).await.expect(201);
    for id in ["elsewhere", "nearly"] {
        let data = if id == "nearly" { NEARLY_HERE } else { ELSEWHERE };
        let body = with_descriptor("megaloc", "int8", data);
        server.put(&format!("/v1/maps/m/keyframes/{id}"), &body).await.expect(201);
    }
    server.patch("/v1/maps/m", &json!({"gravity": [0.0, 1.0, 0.0]})).await.expect(200);
    let query = json!({"keyframe": "here"});
    let ask = async |server: &Server| {
        let read = [server.get("/v1/maps/m").await, server.get(path).await].map(|answer| answer.expect(200));
        (read, server.post("/v1/maps/m/loop-queries", &query).await.expect(200))
    };
    let before = ask(&server).await;
    let ([map, read], verdict) = &before;
    assert_eq!(map["gravity"], json!([0.0, 1.0, 0.0]));
    for field in ["gravity", "height_m", "global_descriptor"] {
        assert_eq!(read[field], sent[field], "{field}");
    }
    // Only the third channel finds it, and leaves open what it is.
    assert_eq!(verdict["candidates"].as_array().map(Vec::len), Some(1));
    let candidate = &verdict["candidates"][0];
    assert_eq!((&candidate["keyframe"], &candidate["channel"]), (&json!("nearly"), &json!(["global"])));
    assert!(candidate["global"]["similarity"].as_f64().unwrap() > 0.999);
    assert_eq!(candidate.get("bow"), None);
    assert_eq!(candidate["reason"]["code"], "no_anchors");
    server.stop().await;

    let server = Server::on(folder.path()).await;
    assert_eq!(ask(&server).await, before);
    assert_eq!(server.put(path, &sent).await.header("idempotent-replayed"), "true");
    for (field, other) in [("height_m", json!(-3.5)), ("gravity", json!([0.0, 1.0, 0.0]))] {
        let mut sent = sent.clone();
        sent[field] = other;
        server.put(path, &sent).await.expect(409);
    }
    // A query without a descriptor says nothing of channels.
    let verdict = server.post("/v1/maps/m/loop-queries", &json!({"inline": keyframe()})).await.expect(200);
    assert_eq!(verdict["candidates"], json!([]));
    server.stop().await;
}
