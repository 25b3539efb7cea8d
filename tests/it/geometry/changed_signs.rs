//! M18: a sign that three passages had in view and did not see is retired, and returns when one reads it twice.
//!
//! One robot drives laps: two views of a door, then away. Every lap has map points of its own, so that what hangs there is
//! found again by geometry, unless a case says that tracking knows them still.

use base64::Engine as _;
use reqwest::Method;
use revisit::geometry::Point3;
use serde_json::{Value, json};

use super::scene::{pose, random};
use crate::support::{Answer, Server};

const PLATE: [f64; 3] = [0.5, 0.0, 3.0];
/// Points of the room, and those of them that are around the plate.
const POINTS: u64 = 120;
const AROUND: u64 = 30;
/// The places from which the robot looks at the door, and those where it goes afterwards.
const STANDS: [[f64; 3]; 6] =
    [[0.0, 0.0, 0.0], [0.1, 0.0, 0.0], [4.5, 0.0, 0.0], [4.6, 0.0, 0.0], [4.7, 0.0, 0.0], [4.8, 0.0, 0.0]];

/// A lap past the door.
#[derive(Clone, Copy)]
struct Lap {
    /// The texts that the two views read.
    reads: [Option<&'static str>; 2],
    /// Whether the map points of the first lap are tracked still.
    is_tracked: bool,
    /// The room that the views show.
    looks_like: u64,
    /// By how much the poses are off, in metres.
    off_m: f64,
}

const fn reads(first: Option<&'static str>, second: Option<&'static str>) -> Lap {
    Lap { reads: [first, second], is_tracked: false, looks_like: 1, off_m: 0.0 }
}

const fn both(text: &'static str) -> Lap {
    reads(Some(text), Some(text))
}

const EMPTY: Lap = reads(None, None);

fn tracked(lap: Lap) -> Lap {
    Lap { is_tracked: true, ..lap }
}

/// A point of the room, and the one of its looks that a byte shows.
fn point(number: u64) -> [f64; 3] {
    let draw = |axis: u64| random(7_000_000 + number * 64 + axis);
    if number < AROUND {
        [PLATE[0] + draw(0) * 0.5 - 0.25, PLATE[1] + draw(1) * 0.5 - 0.25, PLATE[2] + draw(2) * 0.5 - 0.25]
    } else {
        [draw(0) * 3.0 - 1.5, draw(1) * 2.0 - 1.0, draw(2) * 3.0 + 2.5]
    }
}

fn view(lap: Lap, lap_number: u64, stand: usize) -> Value {
    let world_from_camera = pose(STANDS[stand], 0.0);
    let [x, y, z] = STANDS[stand];
    let claimed = pose([x + lap.off_m, y, z], 0.0);
    let number = 6 * lap_number + stand as u64;
    let first_id = 1000 * if lap.is_tracked { 1 } else { lap_number + 1 };
    let (mut keypoints, mut bytes, mut ids, mut positions) = (vec![], vec![], vec![], vec![]);
    for number in (0..POINTS).filter(|_| stand < 2) {
        let at = Point3::from(point(number));
        let seen = world_from_camera.inverse_transform(&at);
        keypoints.push(json!([seen.x / seen.z * 525.0 + 320.0, seen.y / seen.z * 525.0 + 240.0, 0]));
        let look = |byte: u64| random(lap.looks_like * 1_000_000 + number * 64 + 8 + byte);
        bytes.extend((0..32).map(|byte| (look(byte) * 256.0) as u8));
        ids.push(first_id + number);
        positions.push(json!([at.x + lap.off_m, at.y, at.z]));
    }
    let plate = lap.reads.get(stand).copied().flatten();
    let [qx, qy, qz, qw] = claimed.rotation_xyzw();
    let [tx, ty, tz] = claimed.translation_m();
    // Each keyframe shares points with the two before it: tracking is never lost, also where one of them is culled.
    let chain = (0..60).map(|step| 1_000_000 + 20 * number + step);
    let sent = if lap.is_tracked && lap_number > 0 {
        json!({"ids": [], "positions": []})
    } else {
        json!({"ids": ids, "positions": positions})
    };
    json!({
        "session": "a", "stamp": {"sec": number, "nanosec": 0},
        "pose": {"translation": {"x": tx, "y": ty, "z": tz}, "rotation": {"x": qx, "y": qy, "z": qz, "w": qw}},
        "camera": {"fx": 525, "fy": 525, "cx": 320, "cy": 240, "width": 640, "height": 480},
        "bow": {"words": [1, 2], "weights": [1, 1]},
        "observes": chain.collect::<Vec<u64>>(),
        "map_points": sent,
        "features": {"descriptor_bytes": 32, "keypoints": keypoints, "map_points": ids,
            "descriptors": base64::engine::general_purpose::STANDARD.encode(bytes)},
        "detections": plate.map(|text| json!([{"class": "door_number", "confidence": 0.9, "box": [0, 0, 10, 10],
            "text": text, "position": [PLATE[0] + lap.off_m, PLATE[1], PLATE[2]]}])).unwrap_or(json!([])),
    })
}

async fn drive(server: &Server, first: u64, laps: &[Lap]) {
    for (number, lap) in (first..).zip(laps) {
        for stand in 0..STANDS.len() {
            let path = format!("/v1/maps/m/keyframes/kf-{number}-{stand}");
            server.put(&path, &view(*lap, number, stand)).await.expect(201);
        }
    }
}

async fn map(settings: &Value) -> Server {
    let server = Server::start().await;
    server.put("/v1/maps/m", &json!({"settings": settings})).await.expect(201);
    server
}

/// The anchor of the first lap.
async fn plate(server: &Server) -> Value {
    server.get("/v1/maps/m/anchors/a-0").await.expect(200)
}

async fn state(server: &Server) -> String {
    plate(server).await["state"].as_str().unwrap().to_owned()
}

#[tokio::test]
async fn three_passages_that_should_have_seen_a_sign_retire_it() {
    let none = json!({});
    let other = both("944");
    let cases: [(&str, &Value, Vec<Lap>, &str); 13] = [
        ("two are not enough", &none, vec![both("901"), other, other], "valid"),
        ("three", &none, vec![both("901"), other, other, other], "retired"),
        ("read twice, never alike", &none, vec![both("901"), both("944"), both("917"), both("936")], "valid"),
        ("of four, three alike", &none, vec![both("901"), other, both("917"), other, other], "retired"),
        ("not readable", &none, vec![both("901"), both("push"), both("push"), both("push")], "valid"),
        ("seen in between", &none, vec![both("901"), other, other, both("901"), other], "valid"),
        (
            "seen once in between",
            &none,
            vec![both("901"), other, other, reads(None, Some("901")), other],
            "valid",
        ),
        ("gone", &none, vec![both("901"), EMPTY, EMPTY, EMPTY], "retired"),
        (
            "gone, and tracked",
            &none,
            vec![both("901"), tracked(EMPTY), tracked(EMPTY), tracked(EMPTY)],
            "retired",
        ),
        (
            "a room that looks otherwise",
            &none,
            vec![both("901"); 1].into_iter().chain([Lap { looks_like: 2, ..EMPTY }; 3]).collect(),
            "valid",
        ),
        (
            "poses that say that it is another room",
            &none,
            vec![both("901"); 1].into_iter().chain([Lap { off_m: -2.5, ..EMPTY }; 3]).collect(),
            "valid",
        ),
        (
            "switched off",
            &json!({"signs_may_change": false}),
            vec![both("901"), other, other, other],
            "valid",
        ),
        ("the paper's method", &json!({"method": "paper"}), vec![both("901"), other, other, other], "valid"),
    ];
    for (name, settings, laps, expected) in cases {
        let server = map(settings).await;
        drive(&server, 0, &laps).await;
        assert_eq!(state(&server).await, expected, "{name}: {}", plate(&server).await);
    }
}

#[tokio::test]
async fn a_retired_sign_is_listed_with_what_hangs_in_its_place_and_lets_its_place_be_found() {
    let folder = tempfile::tempdir().unwrap();
    let server = Server::on(folder.path()).await;
    server.put("/v1/maps/m", &json!({})).await.expect(201);
    drive(&server, 0, &[both("901"), both("944"), both("944"), both("944")]).await;
    let answer = server.post("/v1/maps/m/loop-queries", &json!({"keyframe": "kf-2-0"})).await.expect(200);
    let mut candidates = answer["candidates"].as_array().unwrap().iter();
    let old = candidates.find(|found| found["keyframe"].as_str().unwrap().starts_with("kf-0"));
    let old = old.unwrap_or_else(|| panic!("{answer:#}"));
    assert_eq!(old["verdict"], "loop", "{old:#}");
    let terms = old["evidence"].as_array().unwrap().iter();
    let said: Vec<&Value> = terms.filter(|term| term["kind"] != "copy" && term["kind"] != "view").collect();
    assert!(said.iter().all(|term| term["log_odds"].as_f64() > Some(0.0)), "{old:#}");
    let sign = plate(&server).await;
    let by = sign["replaced_by"].as_str().expect("an anchor");
    assert_eq!(server.get(&format!("/v1/maps/m/anchors/{by}")).await.expect(200)["description"], "944");
    let listed = server.get("/v1/maps/m/anchors?state=retired").await.expect(200);
    assert_eq!(listed["items"].as_array().unwrap().len(), 1, "{listed}");
    assert_eq!(listed["items"][0]["id"], "a-0");
    server.stop().await;
    let server = Server::on(folder.path()).await;
    assert_eq!(plate(&server).await, sign, "after a restart");
    // A switch, not a loss.
    let switch = async |on: bool| {
        server.patch("/v1/maps/m", &json!({"settings": {"signs_may_change": on}})).await.expect(200);
        state(&server).await
    };
    assert_eq!((switch(false).await.as_str(), switch(true).await.as_str()), ("valid", "retired"));
}

#[tokio::test]
async fn a_retired_sign_returns_when_one_passage_reads_it_twice_or_somebody_describes_it() {
    let retired = [both("901"), both("944"), both("944"), both("944")];
    let server = map(&json!({})).await;
    drive(&server, 0, &retired).await;
    drive(&server, 4, &[reads(None, Some("901"))]).await;
    assert_eq!(state(&server).await, "retired", "read once");
    drive(&server, 5, &[both("901")]).await;
    assert_eq!(state(&server).await, "valid");
    // And again from the start; the loop says that the robot knows where it is.
    let closed = json!({"id": "l", "keyframe": "kf-5-0", "candidate": "kf-0-0"});
    server.post("/v1/maps/m/loops", &closed).await.expect(201);
    drive(&server, 6, &[both("944"), both("944")]).await;
    assert_eq!(state(&server).await, "valid");
    drive(&server, 8, &[both("944")]).await;
    assert_eq!(state(&server).await, "retired");
    let describe = async |text: Value| {
        let request = server.request(Method::PATCH, "/v1/maps/m/anchors/a-0").header("if-match", "*");
        Answer::of(request.json(&json!({"description": text}))).await.expect(200);
    };
    describe(Value::Null).await;
    assert_eq!(state(&server).await, "retired", "nobody described it");
    describe(json!("room 901")).await;
    assert_eq!(state(&server).await, "valid", "somebody knows better");
    drive(&server, 9, &[both("944"), both("944"), both("944")]).await;
    assert_eq!(state(&server).await, "valid", "somebody knows better");
}

#[tokio::test]
async fn a_sign_that_tracking_took_for_the_old_one_becomes_a_sign_of_its_own() {
    let folder = tempfile::tempdir().unwrap();
    let server = Server::on(folder.path()).await;
    server.put("/v1/maps/m", &json!({})).await.expect(201);
    // The map points are known still, so that each new plate feeds the old one's anchor; four readings outvote it not before
    // three passages.
    let first = [both("901"), tracked(both("901")), tracked(both("901")), tracked(both("901"))];
    drive(&server, 0, &first).await;
    drive(&server, 4, &[tracked(both("944")), tracked(both("944"))]).await;
    let before = plate(&server).await;
    assert_eq!((&before["state"], &before["description"]), (&json!("valid"), &json!("901")), "{before}");
    assert_eq!(before["keyframes"].as_array().unwrap().len(), 12, "{before}");
    drive(&server, 6, &[tracked(both("944"))]).await;
    let sign = plate(&server).await;
    assert_eq!((&sign["state"], &sign["description"]), (&json!("retired"), &json!("901")), "{sign}");
    assert_eq!(sign["keyframes"].as_array().unwrap().len(), 8, "{sign}");
    let by = format!("/v1/maps/m/anchors/{}", sign["replaced_by"].as_str().expect("an anchor"));
    let new = server.get(&by).await.expect(200);
    assert_eq!((&new["state"], &new["description"]), (&json!("valid"), &json!("944")), "{new}");
    assert_eq!(new["keyframes"].as_array().unwrap().len(), 6, "{new}");
    drive(&server, 7, &[tracked(both("944"))]).await;
    let new = server.get(&by).await.expect(200);
    assert_eq!(
        new["keyframes"].as_array().unwrap().len(),
        8,
        "what is read from now on is the new one: {new}"
    );
    server.stop().await;
    let server = Server::on(folder.path()).await;
    assert_eq!(server.get(&by).await.expect(200), new, "after a restart");
}

#[tokio::test]
async fn a_passage_counts_although_its_keyframes_are_culled() {
    let server = map(&json!({})).await;
    drive(&server, 0, &[both("901"), both("944"), both("944")]).await;
    server.delete("/v1/maps/m/keyframes/kf-1-1").await.expect(200);
    drive(&server, 3, &[both("944")]).await;
    assert_eq!(state(&server).await, "retired");
}

#[tokio::test]
async fn a_sign_that_hangs_where_a_retired_one_hung_founds_an_anchor_of_its_own() {
    let server = map(&json!({})).await;
    let gone = [both("901"), tracked(EMPTY), tracked(EMPTY), tracked(EMPTY)];
    drive(&server, 0, &gone).await;
    let sign = plate(&server).await;
    assert_eq!((&sign["state"], &sign["replaced_by"]), (&json!("retired"), &Value::Null), "{sign}");
    drive(&server, 4, &[tracked(both("944"))]).await;
    let found = server.get("/v1/maps/m/anchors?text=944").await.expect(200);
    assert_eq!(found["items"][0]["state"], "valid", "{found}");
    assert_eq!(plate(&server).await["description"], "901");
}

/// Holds the poses of the cases.
#[test]
fn the_plate_is_in_view_of_both_stands_and_not_of_the_others() {
    let in_view = |stand: [f64; 3]| {
        let seen = pose(stand, 0.0).inverse_transform(&PLATE.into());
        (0.0..640.0).contains(&(seen.x / seen.z * 525.0 + 320.0))
    };
    assert_eq!(STANDS.map(in_view), [true, true, false, false, false, false]);
}
