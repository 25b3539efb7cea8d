//! A server with a vocabulary computes the words that a client leaves out, and keeps two vocabularies apart.

use base64::Engine as _;
use revisit::vocabulary::train::{TrainSettings, TrainingSet, train};
use serde_json::{Value, json};

use crate::support::Server;

const DESCRIPTOR_BYTES: usize = 32;

/// Descriptors that a formula draws: enough unlike each other to make words of.
fn descriptors(image: u64, count: u64) -> Vec<u8> {
    (0..count * DESCRIPTOR_BYTES as u64)
        .map(|byte| ((byte + 1).wrapping_mul(image + 3).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 56) as u8)
        .collect()
}

fn vocabulary_file(folder: &std::path::Path) -> std::path::PathBuf {
    let mut set = TrainingSet::default();
    for image in 0..8 {
        set.add_image(DESCRIPTOR_BYTES, &descriptors(image, 40)).unwrap();
    }
    let settings = TrainSettings { branching: 4, levels: 3, seed: 1, ..TrainSettings::default() };
    let vocabulary = train(&set, settings, |_| {}).unwrap();
    let path = folder.join("small.voc");
    let mut file = std::fs::File::create(&path).unwrap();
    vocabulary.write_binary(&mut file).unwrap();
    path
}

fn keyframe(image: u64) -> Value {
    let bytes = descriptors(image, 30);
    let encoded = base64::engine::general_purpose::STANDARD.encode(bytes);
    let keypoints: Vec<[f64; 2]> = (0..30).map(|n| [f64::from(n) * 20.0, 100.0]).collect();
    json!({
        "stamp": {"sec": 1, "nanosec": 0},
        "pose": {"translation": {"x": 0, "y": 0, "z": 0}, "rotation": {"x": 0, "y": 0, "z": 0, "w": 1}},
        "features": {"descriptor_bytes": DESCRIPTOR_BYTES, "descriptors": encoded, "keypoints": keypoints,
                     "map_points": vec![-1; 30]},
    })
}

#[tokio::test]
async fn words_are_computed_from_features_and_belong_to_one_vocabulary() {
    let folder = tempfile::tempdir().unwrap();
    let server = Server::with_vocabulary(vocabulary_file(folder.path())).await;
    let named = server.get("/version").await.body["vocabulary"].clone();
    assert_eq!(named.as_str().map(str::len), Some(64), "a fingerprint");
    server.put("/v1/maps/m", &json!({})).await;

    assert_eq!(server.put("/v1/maps/m/keyframes/a", &keyframe(1)).await.status, 201);
    let read = server.get("/v1/maps/m/keyframes/a").await.body;
    assert!(!read["bow"]["words"].as_array().unwrap().is_empty());
    assert_eq!(server.get("/v1/maps/m").await.body["vocabulary"], named);

    // The same image again is alike to the last digit; another one is not.
    for (id, image) in [("same", 1), ("other", 5)] {
        let mut body = keyframe(image);
        body["session"] = json!(id);
        server.put(&format!("/v1/maps/m/keyframes/{id}"), &body).await;
    }
    let verdict = server.post("/v1/maps/m/loop-queries", &json!({"keyframe": "same"})).await.body;
    let score = |id: &str| {
        let found = verdict["candidates"].as_array().unwrap().iter().find(|c| c["keyframe"] == id).cloned();
        found.map_or(0.0, |candidate| candidate["bow"]["score"].as_f64().unwrap())
    };
    assert_eq!(score("a"), 1.0);
    assert!(score("other") < 1.0);

    // Words that the client numbers itself mean something else here.
    let mut own = keyframe(2);
    own["bow"] = json!({"words": [1, 2], "weights": [1, 1]});
    let refused = server.put("/v1/maps/m/keyframes/b", &own).await;
    assert_eq!((refused.status.as_u16(), &refused.body["code"]), (409, &json!("other_vocabulary")));
    own["bow"]["vocabulary"] = named;
    assert_eq!(server.put("/v1/maps/m/keyframes/b", &own).await.status, 201);
    let asked = server
        .post(
            "/v1/maps/m/loop-queries",
            &json!({"inline": {
        "stamp": {"sec": 1, "nanosec": 0}, "pose": own["pose"], "bow": {"words": [1], "weights": [1]}}}),
        )
        .await;
    assert_eq!((asked.status.as_u16(), &asked.body["code"]), (409, &json!("other_vocabulary")));
}
