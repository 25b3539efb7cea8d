//! "Where am I?" asked of maps that are not in memory: the same answer, and only the promising ones are loaded.

use reqwest::Method;
use serde_json::{Value, json};

use crate::support::{Answer, Server};

/// Keyframes of a map, each of a place of its own: more than a map has candidates.
const KEYFRAMES: u32 = 24;

/// A budget in which no map has room.
const NO_MEMORY: u64 = 1;

/// The maps, and how many of the ten words of the question each of their keyframes has. Three maps have as many candidates as
/// are ranked at all.
const MAPS: [(&str, u32); 7] = [("a", 1), ("b", 5), ("c", 5), ("d", 0), ("e", 6), ("f", 2), ("signs", 0)];

async fn fill(server: &Server) {
    for (map, common) in MAPS {
        server.put(&format!("/v1/maps/{map}"), &json!({})).await.expect(201);
        for number in 0..KEYFRAMES {
            // Its own words make each score another one.
            let own = (0..2 + number % 3).map(|word| 100 + 10 * number + word);
            let words: Vec<u32> = (0..common).chain(own).collect();
            let mut body = json!({
                "session": "robot", "stamp": {"sec": 60 * number, "nanosec": 0}, "bow": {"words": words, "weights": vec![1; words.len()]},
                "pose": {"translation": {"x": 100.0 * f64::from(number), "y": 0, "z": 0}, "rotation": {"x": 0, "y": 0, "z": 0, "w": 1}},
            });
            if map == "signs" {
                body["detections"] = json!([{"class": "door_number", "confidence": 0.9, "box": [0, 0, 10, 10],
                    "text": format!("9{number:02}"), "position": [100.0 * f64::from(number), 0, 2]}]);
            }
            server.put(&format!("/v1/maps/{map}/keyframes/kf-{number}"), &body).await.expect(201);
        }
    }
}

fn question() -> Value {
    json!({"keyframe": {"bow": {"words": (0..10).collect::<Vec<u32>>(), "weights": vec![1; 10]}}, "max": 20})
}

async fn ask(server: &Server, question: &Value) -> String {
    Answer::text(server.request(Method::POST, "/v1/locate").json(question)).await
}

#[tokio::test(flavor = "multi_thread")]
async fn maps_on_disk_give_the_answer_of_maps_in_memory_and_few_are_loaded() {
    let folder = tempfile::tempdir().unwrap();
    let server = Server::with_map_memory(folder.path(), u64::MAX).await;
    fill(&server).await;
    let mut signed = question();
    signed["keyframe"]["detections"] = json!([{"class": "door_number", "confidence": 0.9, "box": [0, 0, 10, 10], "text": "905", "position": [0, 0, 2]}]);
    let mut hinted = question();
    hinted["hint"] = json!({"map": "f"});
    let mut near = question();
    near["hint"] = json!({"map": "f", "position": [100, 0, 0]});
    let mut foreign = question();
    foreign["keyframe"]["bow"]["vocabulary"] = json!("another");
    let mut unlike = question();
    unlike["keyframe"]["bow"]["words"] = json!((9000..9010).collect::<Vec<u32>>());
    // The maps that have to be loaded: those of the best words, those with signs, the hinted one; and all where a position is
    // hinted, which ranks the keyframes of each.
    let cases = [(question(), 3), (signed, 4), (hinted, 4), (near, 7), (foreign, 0), (unlike, 0)];
    let mut before = Vec::new();
    for (question, _) in &cases {
        before.push(ask(&server, question).await);
    }
    assert!(before[0].contains("\"map\":\"e\""), "{}", before[0]);
    server.stop().await;

    for ((question, loads), before) in cases.iter().zip(before) {
        // Without room each map that is not needed stays on disk; with room each is loaded, for the next question.
        for (bytes, loads) in [(NO_MEMORY, *loads), (u64::MAX, MAPS.len() as u64)] {
            let server = Server::with_map_memory(folder.path(), bytes).await;
            assert_eq!(ask(&server, question).await, before);
            assert_eq!(server.figure("revisit_map_loads").await, loads, "{question}");
            server.stop().await;
        }
    }
}

#[tokio::test]
async fn what_a_put_sends_may_be_asked_and_its_place_in_the_map_is_not_listened_to() {
    let server = Server::start().await;
    fill(&server).await;
    let asked = ask(&server, &question()).await;
    let mut as_put = question();
    let keyframe = as_put["keyframe"].as_object_mut().unwrap();
    keyframe.insert("session".into(), json!("another"));
    keyframe.insert("observes".into(), json!([1, 2]));
    keyframe.insert("covisible".into(), json!([{"keyframe": "kf-9", "shared": 20}]));
    assert_eq!(ask(&server, &as_put).await, asked);
}
