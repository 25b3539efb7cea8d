//! §V, the last step, over HTTP: planted rooms, planted motions, and what the service makes of them.

use base64::Engine as _;
use revisit::geometry::{Point3, Pose};
use serde_json::{Value, json};

use crate::support::Server;

const POINTS: u64 = 90;

/// Small random numbers in [0, 1) that depend on nothing but their place (splitmix64).
fn random(seed: u64) -> f64 {
    let mut z = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15).wrapping_add(0x1234_5678_9abc_def1);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
}

/// A keyframe of room `room`, taken from `world_from_camera` by a robot whose frame is `session_from_world`.
struct Shot {
    room: u64,
    points: u64,
    world_from_camera: Pose,
    session_from_world: Pose,
    /// The robot's metre, in metres.
    unit_m: f64,
    /// Texts and where they hang in the world.
    plates: Vec<(&'static str, [f64; 3])>,
}

fn pose(translation: [f64; 3], about_y_deg: f64) -> Pose {
    let half = about_y_deg.to_radians() / 2.0;
    Pose::new(translation, [0.0, half.sin(), 0.0, half.cos()]).unwrap()
}

impl Shot {
    fn of(room: u64, world_from_camera: Pose) -> Self {
        let session_from_world = Pose::identity();
        Self { room, points: POINTS, world_from_camera, session_from_world, unit_m: 1.0, plates: Vec::new() }
    }

    fn plates(mut self, plates: &[(&'static str, [f64; 3])]) -> Self {
        self.plates = plates.to_vec();
        self
    }

    fn in_session(&self, point: &Point3) -> [f64; 3] {
        let p = self.session_from_world.transform(point) / self.unit_m;
        [p.x, p.y, p.z]
    }

    fn body(&self, session: &str, features: bool) -> Value {
        let map_from_camera = self.session_from_world.after(&self.world_from_camera);
        let [tx, ty, tz] = map_from_camera.translation_m().map(|t| t / self.unit_m);
        let [qx, qy, qz, qw] = map_from_camera.rotation_xyzw();
        let (mut keypoints, mut bytes, mut ids, mut positions) = (vec![], vec![], vec![], vec![]);
        for number in 0..self.points {
            let draw = |axis: u64| random(self.room * 1_000_000 + number * 64 + axis);
            let point = Point3::new(draw(0) * 5.0 - 2.5, draw(1) * 3.0 - 1.5, draw(2) * 4.0 + 2.5);
            let seen = self.world_from_camera.inverse_transform(&point);
            if seen.z < 0.3 {
                continue;
            }
            keypoints.push(json!([seen.x / seen.z * 525.0 + 320.0, seen.y / seen.z * 525.0 + 240.0, 0]));
            bytes.extend((0..32).map(|byte| (draw(8 + byte) * 256.0) as u8));
            ids.push(number);
            positions.push(json!(self.in_session(&point)));
        }
        let mut body = json!({
            "session": session, "stamp": {"sec": 1, "nanosec": 0},
            "pose": {"translation": {"x": tx, "y": ty, "z": tz}, "rotation": {"x": qx, "y": qy, "z": qz, "w": qw}},
            "bow": {"words": [1, 2], "weights": [1, 1]},
            "detections": self.plates.iter().map(|(text, at)| json!({
                "class": "door_number", "confidence": 0.9, "box": [0, 0, 10, 10], "text": text,
                "position": self.in_session(&Point3::from(*at))})).collect::<Vec<_>>(),
        });
        if features {
            body["camera"] = json!({"fx": 525, "fy": 525, "cx": 320, "cy": 240, "width": 640, "height": 480});
            body["map_points"] = json!({"ids": ids, "positions": positions});
            body["features"] = json!({"descriptor_bytes": 32, "keypoints": keypoints, "map_points": ids,
                "descriptors": base64::engine::general_purpose::STANDARD.encode(bytes)});
        }
        body
    }
}

async fn map(settings: Value, metric: bool) -> Server {
    let server = Server::start().await;
    server.put("/v1/maps/m", &json!({"settings": settings, "metric": metric})).await.expect(201);
    server
}

async fn store(server: &Server, id: &str, body: &Value) {
    server.put(&format!("/v1/maps/m/keyframes/{id}"), body).await.expect(201);
}

async fn ask(server: &Server, verify: &str) -> Value {
    server.post("/v1/maps/m/loop-queries", &json!({"keyframe": "query", "verify": verify})).await.expect(200)
}

/// The verdict, and the only candidate.
async fn asked(candidate: &Value, query: &Value, settings: Value, verify: &str) -> (String, Value) {
    let server = map(settings, true).await;
    store(&server, "candidate", candidate).await;
    store(&server, "query", query).await;
    let answer = ask(&server, verify).await;
    (answer["verdict"].as_str().unwrap().to_owned(), answer["candidates"][0].clone())
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or(f64::NAN)
}

/// How far an answered transformation is from the planted one: metres, degrees.
fn off(answered: &Value, planted: &Pose) -> (f64, f64) {
    let (t, r) = (&answered["translation"], &answered["rotation"]);
    let answered =
        Pose::new(["x", "y", "z"].map(|axis| number(&t[axis])), ["x", "y", "z", "w"].map(|i| number(&r[i])));
    let answered = answered.expect("a rotation");
    let [.., w] = planted.inverse().after(&answered).rotation_xyzw();
    ((planted.centre() - answered.centre()).norm(), 2.0 * w.abs().min(1.0).acos().to_degrees())
}

const DOOR: (&str, [f64; 3]) = ("room 901", [0.5, 0.0, 3.0]);

fn query_pose() -> Pose {
    pose([0.4, 0.1, 0.3], 10.0)
}

#[tokio::test]
async fn the_same_room_is_verified_and_the_planted_transformation_found() {
    let candidate = Shot::of(1, Pose::identity()).plates(&[DOOR]);
    let mut query = Shot::of(1, query_pose()).plates(&[DOOR]);
    // The second robot's frame lies elsewhere and is turned.
    query.session_from_world = pose([10.0, -3.0, 2.0], 70.0);
    let (verdict, found) = asked(&candidate.body("a", true), &query.body("b", true), json!({}), "auto").await;
    assert_eq!((verdict.as_str(), &found["geometry"]["status"]), ("loop", &json!("verified")), "{found:#}");
    assert!(number(&found["geometry"]["inliers"]) >= 20.0, "{found:#}");
    let transform = &found["geometry"]["candidate_from_query"];
    let (metres, degrees) = off(transform, &query_pose());
    assert!(metres < 0.01 && degrees < 0.2, "{metres} m, {degrees} degrees");
    assert_eq!(number(&transform["scale"]), 1.0);
}

#[tokio::test]
async fn another_room_with_the_same_plate_is_refused_by_geometry_and_by_nothing_else() {
    let candidate = Shot::of(1, Pose::identity()).plates(&[DOOR]);
    let query = Shot::of(2, query_pose()).plates(&[DOOR]);
    let check = async |features: bool, verify: &str, expected: [&str; 3]| {
        let (verdict, found) =
            asked(&candidate.body("a", true), &query.body("b", features), json!({}), verify).await;
        let code = found["reason"]["code"].as_str().unwrap_or("none");
        let status = found["geometry"]["status"].as_str().unwrap();
        assert_eq!([verdict.as_str(), status, code], expected, "{verify}: {found:#}");
    };
    check(true, "auto", ["no_loop", "failed", "too_few_inliers"]).await;
    check(true, "geometry", ["no_loop", "failed", "too_few_inliers"]).await;
    check(true, "anchors", ["loop", "skipped", "none"]).await;
    check(false, "auto", ["loop", "skipped", "none"]).await;
    check(false, "geometry", ["undecided", "skipped", "no_features"]).await;
}

#[tokio::test]
async fn geometry_on_map_points_is_a_witness_of_a_text_without_an_identifier() {
    let shot = |room, pose, session, features| {
        Shot::of(room, pose).plates(&[("Be Updated", [0.5, 0.0, 3.0])]).body(session, features)
    };
    let check = async |room: u64, features: bool, verify: &str, expected: [&str; 3]| {
        let candidate = shot(1, Pose::identity(), "a", true);
        let query = shot(room, query_pose(), "b", features);
        let (verdict, found) = asked(&candidate, &query, json!({}), verify).await;
        let code = found["reason"]["code"].as_str().unwrap_or("none");
        let status = found["geometry"]["status"].as_str().unwrap();
        assert_eq!([verdict.as_str(), status, code], expected, "{verify}: {found:#}");
    };
    check(1, true, "auto", ["loop", "verified", "none"]).await;
    check(1, true, "anchors", ["undecided", "skipped", "no_witness"]).await;
    check(1, false, "auto", ["undecided", "skipped", "no_witness"]).await;
    check(2, true, "auto", ["no_loop", "failed", "too_few_inliers"]).await;
}

#[tokio::test]
async fn without_anchors_geometry_decides_only_where_the_map_says_so() {
    let candidate = Shot::of(1, Pose::identity());
    let check = async |room: u64, features: bool, policy: &str, expected: [&str; 2]| {
        let query = Shot::of(room, query_pose()).body("b", features);
        let settings = json!({"without_anchors": policy});
        let (verdict, found) = asked(&candidate.body("a", true), &query, settings, "auto").await;
        assert_eq!(
            [verdict.as_str(), found["reason"]["code"].as_str().unwrap_or("none")],
            expected,
            "{found:#}"
        );
    };
    check(1, true, "geometry", ["loop", "none"]).await;
    check(2, true, "geometry", ["no_loop", "too_few_inliers"]).await;
    check(1, false, "geometry", ["undecided", "no_features"]).await;
    check(1, true, "undecided", ["undecided", "no_anchors"]).await;
    check(1, true, "reject", ["no_loop", "no_anchors"]).await;
}

#[tokio::test]
async fn matched_anchors_must_stand_where_the_transformation_puts_them() {
    // 40 degrees apart at 4 m: within pi/3 and at the same distance, and 2.7 m from each other.
    let angle = 40.0_f64.to_radians();
    let candidate = Shot::of(1, Pose::identity()).plates(&[("room 901", [0.0, 0.0, 4.0])]).body("a", true);
    let query = Shot::of(1, Pose::identity())
        .plates(&[("room 901", [4.0 * angle.sin(), 0.0, 4.0 * angle.cos()])])
        .body("b", true);
    let (verdict, found) = asked(&candidate, &query, json!({}), "auto").await;
    assert_eq!(verdict, "no_loop", "{found:#}");
    assert_eq!(found["reason"]["code"], "anchors_disagree_with_transform");
    assert_eq!((number(&found["reason"]["measured"]), number(&found["reason"]["limit"])), (0.0, 0.3));
    let (verdict, _) = asked(&candidate, &query, json!({"aligned_anchors": false}), "auto").await;
    assert_eq!(verdict, "loop");
}

#[tokio::test]
async fn identifiers_contradict_under_the_transformation_where_bearings_cannot_tell() {
    // From 1.5 m nearer a plate's distance changes by 1.5 m: no contradiction by the gates of §V-B, but the same
    // place. Weights: 1/2.5 + 1/1 against 1/5.39 + 1/5.02 of the plate that matches.
    let near = |text| (text, [0.0, 0.0, 2.5]);
    let side = ("room 901", [5.0, 0.0, 2.0]);
    let settings = json!({"anchor_map_min_similarity": 0.1});
    let candidate = Shot::of(1, Pose::identity()).plates(&[side, near("room 777")]).body("a", true);
    let closer = || Shot::of(1, pose([0.0, 0.0, 1.5], 0.0));
    let query = closer().plates(&[side, near("room 955")]).body("b", true);
    let (verdict, found) = asked(&candidate, &query, settings.clone(), "anchors").await;
    assert_eq!(verdict, "loop", "{found:#}");
    let (verdict, found) = asked(&candidate, &query, settings.clone(), "auto").await;
    assert_eq!(
        (verdict.as_str(), &found["reason"]["code"]),
        ("no_loop", &json!("contradiction")),
        "{found:#}"
    );
    assert_eq!(found["anchors"]["contradictions"][0]["reason"], "reads 955 where 777 hung");
    // A metre away it is another plate.
    let query = closer().plates(&[side, ("room 955", [1.0, 0.0, 2.5])]).body("b", true);
    assert_eq!(asked(&candidate, &query, settings, "auto").await.0, "loop");
}

#[tokio::test]
async fn the_best_loop_is_the_one_with_most_inliers() {
    let server = map(json!({"without_anchors": "geometry"}), true).await;
    for (id, points) in [("a-few", 45), ("b-most", POINTS)] {
        let mut shot = Shot::of(1, Pose::identity());
        shot.points = points;
        store(&server, id, &shot.body(id, true)).await;
    }
    store(&server, "query", &Shot::of(1, query_pose()).body("q", true)).await;
    let answer = ask(&server, "auto").await;
    assert_eq!(answer["loops"], json!(["b-most", "a-few"]), "{answer:#}");
}

#[tokio::test]
async fn a_map_without_metres_finds_the_scale_and_settings_gate() {
    let server = map(json!({"without_anchors": "geometry"}), false).await;
    let mut candidate = Shot::of(1, Pose::identity());
    // The first robot's unit is half a metre: its numbers are twice as large.
    candidate.unit_m = 0.5;
    store(&server, "candidate", &candidate.body("a", true)).await;
    store(&server, "query", &Shot::of(1, query_pose()).body("b", true)).await;
    let found = ask(&server, "auto").await["candidates"][0].clone();
    assert_eq!(found["verdict"], "loop", "{found:#}");
    let scale = number(&found["geometry"]["candidate_from_query"]["scale"]);
    assert!((scale - 2.0).abs() < 0.02, "{scale}");
    server.patch("/v1/maps/m", &json!({"settings": {"geometry_min_inliers": 1000}})).await.expect(200);
    let found = ask(&server, "auto").await["candidates"][0].clone();
    assert_eq!(
        (&found["reason"]["code"], number(&found["reason"]["limit"])),
        (&json!("too_few_inliers"), 1000.0)
    );
}

#[tokio::test]
async fn points_that_nobody_has_triangulated_are_verified_by_directions_alone() {
    let candidate = Shot::of(1, Pose::identity()).plates(&[DOOR]);
    let flat = |shot: &Shot, session: &str| {
        let mut body = shot.body(session, true);
        body["map_points"] = json!({"ids": [], "positions": []});
        body
    };
    let check = async |query: &Shot, expected: [&str; 3]| {
        let (verdict, found) = asked(&flat(&candidate, "a"), &flat(query, "b"), json!({}), "geometry").await;
        let geometry = &found["geometry"];
        let said =
            [verdict.as_str(), geometry["model"].as_str().unwrap(), geometry["status"].as_str().unwrap()];
        assert_eq!(said, expected, "{found:#}");
        found
    };
    let moved = Shot::of(1, query_pose()).plates(&[DOOR]);
    let found = check(&moved, ["loop", "essential", "verified"]).await;
    // The direction is the planted one; its length nobody knows, and 1 is said.
    let t =
        ["x", "y", "z"].map(|axis| number(&found["geometry"]["candidate_from_query"]["translation"][axis]));
    let planted = query_pose().translation_m();
    let length = planted.iter().map(|x| x * x).sum::<f64>().sqrt();
    assert!((0..3).all(|axis| (t[axis] - planted[axis] / length).abs() < 0.01), "{t:?}");
    check(&Shot::of(2, query_pose()).plates(&[DOOR]), ["no_loop", "essential", "failed"]).await;
    // A camera that only turned.
    check(&Shot::of(1, pose([0.0; 3], 12.0)).plates(&[DOOR]), ["no_loop", "essential", "failed"]).await;
}

#[tokio::test]
async fn a_thousand_times_the_same_question_from_eight_clients_gets_the_same_bytes() {
    let server = map(json!({}), true).await;
    store(&server, "candidate", &Shot::of(1, Pose::identity()).plates(&[DOOR]).body("a", true)).await;
    store(&server, "query", &Shot::of(1, query_pose()).plates(&[DOOR]).body("b", true)).await;
    let question = json!({"keyframe": "query", "seed": 7});
    let first = server
        .request(reqwest::Method::POST, "/v1/maps/m/loop-queries")
        .json(&question)
        .send()
        .await
        .unwrap();
    let timing = first.headers()["server-timing"].to_str().unwrap().to_owned();
    assert!(["screen", "features", "geometry"].iter().all(|step| timing.contains(step)), "{timing}");
    let first = first.bytes().await.unwrap();
    let clients = (0..8).map(|_| {
        let (request, first) =
            (server.request(reqwest::Method::POST, "/v1/maps/m/loop-queries"), first.clone());
        let request = request.json(&question);
        tokio::spawn(async move {
            for _ in 0..125 {
                let answer = request.try_clone().unwrap().send().await.unwrap();
                assert_eq!(answer.bytes().await.unwrap(), first);
            }
        })
    });
    for client in clients.collect::<Vec<_>>() {
        client.await.unwrap();
    }
    let other =
        server.post("/v1/maps/m/loop-queries", &json!({"keyframe": "query", "seed": 8})).await.expect(200);
    assert_ne!(other["id"], serde_json::from_slice::<Value>(&first).unwrap()["id"]);
}
