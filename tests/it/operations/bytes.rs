//! Bytes: random bodies that the API allows come through store, check, backup and restore with equal answers.
//!
//! A few cases; `proofs/bytes` tries many more kinds of them, over the command line too.

use std::collections::BTreeMap;

use proptest::prelude::*;
use proptest::strategy::ValueTree as _;
use proptest::test_runner::TestRunner;
use revisit::integrity::backup::Copy;
use revisit::integrity::restore::{Allowed, restore};
use revisit::store::files::paths::DatabaseFiles;
use serde_json::{Value, json};

use super::sound;
use crate::support::Server;

const DATABASES: usize = 3;
const KEYFRAMES: usize = 12;

fn metres() -> impl Strategy<Value = f64> {
    prop_oneof![4 => -5.0..5.0, 1 => prop::sample::select(vec![0.0, -0.0, 1e9, -1e9, 5e-324, -2.2e-308, 7.0])]
}

fn point() -> impl Strategy<Value = i64> {
    prop_oneof![8 => 0..40_i64, 1 => prop::sample::select(vec![1 << 31, 1 << 53, i64::MAX - 1, i64::MAX])]
}

/// Numbers in any order, with repeats and gaps.
fn observed() -> impl Strategy<Value = Vec<i64>> {
    prop::collection::vec(point(), 0..50)
}

fn placed() -> impl Strategy<Value = Value> {
    let placed = prop::collection::hash_map(point(), prop::array::uniform3(metres()), 0..30);
    placed.prop_map(|placed| {
        // A hash map's order, which is none.
        let (ids, positions): (Vec<i64>, Vec<[f64; 3]>) = placed.into_iter().unzip();
        json!({"ids": ids, "positions": positions})
    })
}

fn bow() -> impl Strategy<Value = Value> {
    let weight = prop::sample::select(vec![0.0, -0.0, 5e-324, 1e30, 1.0, 0.25]);
    prop::collection::hash_map(prop_oneof![0..30_u32, Just(u32::MAX)], weight, 0..20).prop_map(|bow| {
        let (words, weights): (Vec<u32>, Vec<f64>) = bow.into_iter().unzip();
        json!({"words": words, "weights": weights})
    })
}

fn detection() -> impl Strategy<Value = Value> {
    let texts = vec!["901", "EXIT", "出口 3", "e\u{301}tage", "👩‍🚒", "\"\\\u{2028}", " ", "Level 5"];
    let class = prop::sample::select(vec!["sign", "door_number", "Türschild"]);
    let confidence = prop::sample::select(vec![0.0, -0.0, 5e-324, 1.0, 0.3]);
    (
        class,
        confidence,
        observed(),
        prop::option::of(prop::array::uniform3(metres())),
        prop::sample::select(texts),
    )
        .prop_map(|(class, confidence, points, position, text)| {
            let mut body = json!({"class": class, "confidence": confidence, "box": [-1e6, -0.0, 1e6, 5e-324],
                "map_points": points, "text": text, "crop": "iVBORw0KGgo="});
            if let Some(position) = position {
                body["position"] = json!(position);
            }
            body
        })
}

fn keyframe() -> impl Strategy<Value = Value> {
    let session = prop::sample::select(vec!["default", "Z.9:_-"]);
    let sec = prop::sample::select(vec![0, -62_135_596_800, 253_402_300_799_i64]);
    let rotation =
        prop::sample::select(vec![[0.0, -0.0, 0.0, 1.0], [0.5, -0.5, 0.5, -0.5], [5e-324, 0.0, 1.005, 0.0]]);
    let head = (session, sec, prop::array::uniform3(metres()), rotation);
    (head, observed(), placed(), bow(), prop::collection::vec(detection(), 0..4)).prop_map(
        |((session, sec, [x, y, z], [i, j, k, w]), observes, map_points, bow, detections)| {
            json!({"session": session, "stamp": {"sec": sec, "nanosec": 999_999_999},
                "pose": {"translation": {"x": x, "y": y, "z": z}, "rotation": {"x": i, "y": j, "z": k, "w": w}},
                "features": {"descriptor_bytes": 16, "descriptors": "AAECAwQFBgcICQoLDA0ODw==", "keypoints": [[-1e6, -0.0, 63]],
                    "map_points": [observes.first().copied().unwrap_or(-1)]},
                "observes": observes, "map_points": map_points, "bow": bow, "detections": detections})
        },
    )
}

/// Everything that can be read of the map, as text.
async fn answers(server: &Server) -> BTreeMap<String, String> {
    let mut found = BTreeMap::new();
    let keyframes = (0..KEYFRAMES).map(|number| format!("/v1/maps/m/keyframes/kf-{number}"));
    let views =
        keyframes.flat_map(|at| ["", "/covisible", "/local-anchor-map"].map(|view| format!("{at}{view}")));
    for path in views.chain(["/v1/maps/m".to_owned(), "/v1/maps/m/anchors?limit=1000".to_owned()]) {
        found.insert(path.clone(), server.get(&path).await.expect(200).to_string());
    }
    for number in 0..KEYFRAMES {
        let query = json!({"keyframe": format!("kf-{number}"), "seed": 7});
        let answer = server.post("/v1/maps/m/loop-queries", &query).await.expect(200);
        found.insert(format!("query {number}"), answer.to_string());
    }
    found
}

#[tokio::test(flavor = "multi_thread")]
async fn whatever_is_allowed_is_checked_backed_up_and_restored_with_equal_answers() {
    let mut random = TestRunner::deterministic();
    let strategy = prop::collection::vec(keyframe(), KEYFRAMES);
    for _ in 0..DATABASES {
        let bodies = strategy.new_tree(&mut random).unwrap().current();
        let folder = tempfile::tempdir().unwrap();
        let server = Server::on(folder.path()).await;
        let settings = json!({"settings": {"covisibility_min_shared_points": 3}});
        server.put("/v1/maps/m", &settings).await.expect(201);
        for (number, body) in bodies.iter().enumerate() {
            server.put(&format!("/v1/maps/m/keyframes/kf-{number}"), body).await.expect(201);
        }
        let mut corrected = json!({"map_points": {"ids": [7, 3, i64::MAX], "positions": [[0.5, -0.0, 1], [1, 2, 3], [5e-324, 0, 0]]}});
        corrected["session"] = bodies[0]["session"].clone();
        server.post("/v1/maps/m/poses", &corrected).await.expect(200);
        let before = answers(&server).await;
        server.stop().await;

        let database = folder.path().join("test.db");
        sound(&database).await;
        let copy = Copy::of(&DatabaseFiles::of_path(&database), folder.path()).await.unwrap();
        assert!(copy.faults().is_empty(), "{:?}", copy.faults());
        let backup = folder.path().join("backup.db");
        copy.place(&backup, false).unwrap();
        let elsewhere = tempfile::tempdir().unwrap();
        let target = DatabaseFiles::of_path(&elsewhere.path().join("test.db"));
        restore(&DatabaseFiles::of_path(&backup), &target, Allowed::default()).await.unwrap();
        for directory in [folder.path(), elsewhere.path()] {
            let server = Server::on(directory).await;
            let after = answers(&server).await;
            for (path, answer) in &before {
                assert_eq!(Some(answer), after.get(path), "{path}");
            }
            for (number, body) in bodies.iter().enumerate() {
                server.put(&format!("/v1/maps/m/keyframes/kf-{number}"), body).await.expect(200);
            }
            server.stop().await;
        }
    }
}
