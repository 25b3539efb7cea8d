//! What a map may hold.

use revisit::config::quotas::Quotas;
use serde_json::{Value, json};

use crate::support::{Server, keyframe};

fn with_plate(text: &str, x: f64) -> Value {
    let mut body = keyframe();
    body["detections"] = json!([{"class": "door_number", "confidence": 0.9, "box": [0, 0, 9, 9],
        "position": [x, 0.0, 2.0], "text": text}]);
    body
}

#[tokio::test]
async fn a_full_map_refuses_keyframes_and_goes_on_reading_and_deleting() {
    let full = |quotas: Quotas| async move {
        let server = Server::with_quotas(quotas).await;
        server.put("/v1/maps/m", &json!({})).await.expect(201);
        server.put("/v1/maps/m/keyframes/a", &with_plate("901", 0.0)).await.expect(201);
        server.put("/v1/maps/m/keyframes/b", &with_plate("902", 9.0)).await.expect(201);
        let refused = server.put("/v1/maps/m/keyframes/c", &with_plate("903", 18.0)).await.expect(507);
        assert_eq!(refused["code"], "map_full", "{refused}");
        server.put("/v1/maps/m/keyframes/a", &with_plate("901", 0.0)).await.expect(200);
        let map = server.get("/v1/maps/m").await.expect(200);
        server.put("/v1/maps/other", &json!({})).await.expect(201);
        server.put("/v1/maps/other/keyframes/c", &with_plate("903", 18.0)).await.expect(201);
        server.delete("/v1/maps/m/keyframes/a").await.expect(200);
        server.put("/v1/maps/m/keyframes/c", &with_plate("903", 18.0)).await.expect(201);
        (refused, map)
    };
    let quotas = Quotas::default();
    let (refused, _) = full(Quotas { map_max_keyframes: Some(2), ..quotas }).await;
    assert!(refused["detail"].as_str().expect("a text").contains("2 keyframes"), "{refused}");
    let (refused, _) = full(Quotas { map_max_anchors: Some(2), ..quotas }).await;
    assert!(refused["detail"].as_str().expect("a text").contains("2 anchors"), "{refused}");
}

#[tokio::test]
async fn a_map_counts_the_bytes_of_its_keyframes() {
    // Three words (8 bytes each) and two observed points (8 bytes each).
    const BYTES: u64 = 3 * 8 + 2 * 8;
    let server = Server::with_quotas(Quotas { map_max_bytes: Some(2 * BYTES), ..Quotas::default() }).await;
    let mut body = keyframe();
    body["bow"] = json!({"words": [1, 2, 3], "weights": [1, 1, 1]});
    body["observes"] = json!([4, 5]);
    server.put("/v1/maps/m", &json!({})).await.expect(201);
    for (keyframe, status, bytes) in [("a", 201, BYTES), ("b", 201, 2 * BYTES), ("c", 507, 2 * BYTES)] {
        server.put(&format!("/v1/maps/m/keyframes/{keyframe}"), &body).await.expect(status);
        assert_eq!(server.get("/v1/maps/m").await.expect(200)["bytes"], bytes);
    }
    server.delete("/v1/maps/m/keyframes/a").await.expect(200);
    assert_eq!(server.get("/v1/maps/m").await.expect(200)["bytes"], BYTES);
}
