//! "Where am I?": keyframes without a pose against maps, over HTTP.

use reqwest::Method;
use revisit::geometry::Pose;
use serde_json::{Value, json};

use crate::geometry::scene::{POINTS, Shot, off, pose, query_pose};
use crate::support::{Answer, Server};

/// A sign of a corridor: its number, and its position in the session's frame.
type Sign = (&'static str, [f64; 3]);

/// A corridor along z with doors on both sides, as a robot sees it that drives along it.
const CORRIDOR: [Sign; 6] = [
    ("901", [1.5, -0.4, 3.0]),
    ("902", [-1.5, -0.4, 4.5]),
    ("903", [1.5, -0.6, 6.5]),
    ("904", [-1.5, -0.4, 9.0]),
    ("905", [1.5, -0.4, 11.5]),
    ("906", [-1.5, -0.5, 14.0]),
];

fn transform(pose: &Pose) -> Value {
    let ([x, y, z], [qx, qy, qz, qw]) = (pose.translation_m(), pose.rotation_xyzw());
    json!({"translation": {"x": x, "y": y, "z": z}, "rotation": {"x": qx, "y": qy, "z": qz, "w": qw}})
}

fn detection(text: &str, position: [f64; 3]) -> Value {
    json!({"class": "door_number", "confidence": 0.95, "box": [0, 0, 10, 10], "text": text, "position": position})
}

/// Drives along a corridor of these signs, a keyframe every two metres.
async fn drive(server: &Server, map: &str, signs: &[Sign], gravity: Option<[f64; 3]>) {
    server.put(&format!("/v1/maps/{map}"), &json!({})).await.expect(201);
    drive_on(server, map, signs, gravity).await;
}

/// Drives in a map that exists.
async fn drive_on(server: &Server, map: &str, signs: &[Sign], gravity: Option<[f64; 3]>) {
    for number in 0..7 {
        let at = f64::from(number) * 2.0;
        let ahead = signs.iter().filter(|(_, [.., z])| (0.5..7.0).contains(&(z - at)));
        let mut body = json!({
            "session": "robot", "stamp": {"sec": number, "nanosec": 0}, "pose": transform(&pose([0.0, 0.0, at], 0.0)),
            "detections": ahead.map(|(text, place)| detection(text, *place)).collect::<Vec<_>>(),
        });
        if let Some(gravity) = gravity {
            body["gravity"] = json!(gravity);
        }
        server.put(&format!("/v1/maps/{map}/keyframes/kf-{number}"), &body).await.expect(201);
    }
}

/// What a camera at `map_from_camera` sees of these signs.
fn sighted(map_from_camera: &Pose, signs: &[Sign]) -> Value {
    let seen = signs.iter().map(|(text, place)| {
        let point = map_from_camera.inverse_transform(&(*place).into());
        detection(text, [point.x, point.y, point.z])
    });
    json!({"detections": seen.collect::<Vec<_>>()})
}

async fn locate(server: &Server, question: &Value) -> Value {
    server.post("/v1/locate", question).await.expect(200)
}

fn confidence(answer: &Value) -> f64 {
    answer["confidence"].as_f64().unwrap()
}

#[tokio::test]
async fn signs_tell_the_pose_as_far_as_their_number_and_the_vertical_allow() {
    let upright = pose([0.3, 0.0, 1.0], 25.0);
    let near = pose([0.3, 0.0, 0.5], 10.0);
    // Pitched by 20 degrees besides.
    let (s, c) = 10_f64.to_radians().sin_cos();
    let tilted = upright.after(&Pose::new([0.0; 3], [s, 0.0, 0.0, c]).unwrap());
    let down = |pose: &Pose| {
        let tip =
            pose.inverse().transform(&[0.0, 1.0, 0.0].into()) - pose.inverse().transform(&[0.0; 3].into());
        [tip.x, tip.y, tip.z]
    };
    // Camera, whether gravity is told, number of signs, what is assumed, whether a pose comes out.
    let cases = [
        (&near, false, 1, json!(null), false),
        (&upright, false, 2, json!(["upright"]), true),
        (&upright, true, 2, json!(null), true),
        (&tilted, true, 2, json!(null), true),
        (&tilted, false, 4, json!(null), true),
    ];
    for (camera, has_gravity, count, assumed, has_pose) in cases {
        let server = Server::start().await;
        drive(&server, "tower", &CORRIDOR, has_gravity.then_some([0.0, 1.0, 0.0])).await;
        let mut keyframe = sighted(camera, &CORRIDOR[..count]);
        if has_gravity {
            keyframe["gravity"] = json!(down(camera));
        }
        let answer = locate(&server, &json!({"keyframe": keyframe})).await;
        let (place, case) = (&answer["places"][0], format!("{count} signs, gravity {has_gravity}: {answer}"));
        assert_eq!(place["map"], "tower", "{case}");
        assert_eq!(answer["verdict"] == "located", count >= 2, "{case}");
        assert_eq!(place["map_from_camera"].is_object(), has_pose, "{case}");
        assert_eq!(place["assumed"], assumed, "{case}");
        if has_pose {
            let (metres, degrees) = off(&place["map_from_camera"], camera);
            assert!(metres < 0.01 && degrees < 0.5, "{metres} m, {degrees} degrees: {case}");
            let known = place["uncertainty"]["translation_m"].as_f64().unwrap();
            assert!((0.1..3.0).contains(&known), "{case}");
        }
    }
}

#[tokio::test]
async fn twin_floors_are_ambiguous_until_a_sign_tells_them_apart() {
    let server = Server::start().await;
    let mut upper = CORRIDOR;
    upper[3].0 = "1004";
    drive(&server, "ninth", &CORRIDOR, None).await;
    drive(&server, "tenth", &upper, None).await;
    let camera = pose([0.2, 0.0, 1.0], 5.0);
    let answer = locate(&server, &json!({"keyframe": sighted(&camera, &CORRIDOR[..3])})).await;
    assert_eq!(answer["verdict"], "ambiguous", "{answer}");
    assert_eq!(answer["reason"]["code"], "places_alike");
    assert!(confidence(&answer) < 0.99);
    let maps: Vec<&Value> =
        answer["places"].as_array().unwrap().iter().take(2).map(|place| &place["map"]).collect();
    assert_eq!(maps, ["ninth", "tenth"]);
    let told: Vec<(&Value, &Value)> = answer["look_for"]
        .as_array()
        .unwrap()
        .iter()
        .map(|sign| (&sign["map"], &sign["description"]))
        .collect();
    assert!(told.contains(&(&json!("ninth"), &json!("904"))), "{answer}");
    assert!(told.contains(&(&json!("tenth"), &json!("1004"))), "{answer}");
    // The robot turns its head: two keyframes with poses of its own say what one did not.
    let turned = pose([0.2, 0.0, 3.0], 5.0);
    let mut views = [sighted(&camera, &CORRIDOR[..3]), sighted(&turned, &upper[3..4])];
    // Its own frame begins where its first keyframe stands; positions are in that frame.
    let own = |world: &Pose| camera.inverse().after(world);
    for (view, world) in views.iter_mut().zip([&camera, &turned]) {
        let own = own(world);
        view["pose"] = transform(&own);
        for detection in view["detections"].as_array_mut().unwrap() {
            let position: [f64; 3] = serde_json::from_value(detection["position"].clone()).unwrap();
            let point = own.transform(&position.into());
            detection["position"] = json!([point.x, point.y, point.z]);
        }
    }
    let answer = locate(&server, &json!({"keyframes": views})).await;
    assert_eq!(
        (&answer["verdict"], &answer["places"][0]["map"]),
        (&json!("located"), &json!("tenth")),
        "{answer}"
    );
    let (metres, _) = off(&answer["places"][0]["map_from_camera"], &camera);
    assert!(metres < 0.01, "{answer}");
    // A hint looks there first, and decides nothing.
    let hint = json!({"map": "ninth", "position": [0, 0, 0], "radius_m": 3});
    let again = locate(&server, &json!({"keyframes": views, "hint": hint})).await;
    assert_eq!(again["places"][0]["map"], "tenth");
}

#[tokio::test]
async fn floors_that_one_letter_of_a_plate_tells_apart_are_told_apart() {
    let server = Server::start().await;
    let floor = |texts: [&'static str; 6]| {
        let mut floor = CORRIDOR;
        floor.iter_mut().zip(texts).for_each(|(sign, text)| sign.0 = text);
        floor
    };
    let of_d = floor(["ML D 31", "ML D 32", "ML D 33", "ML D 34", "ML D 35", "ML D 36"]);
    let of_e = floor(["ML E 31", "ML E 32", "ML E 33", "ML E 34", "ML E 35", "ML E 36"]);
    let camera = pose([0.2, 0.0, 3.0], 5.0);
    let question = json!({"keyframe": sighted(&camera, &of_e[1..3])});
    drive(&server, "floor-d", &of_d, None).await;
    // Its own floor is not mapped yet.
    let answer = locate(&server, &question).await;
    assert_ne!(answer["verdict"], "located", "{answer}");
    drive(&server, "floor-e", &of_e, None).await;
    let answer = locate(&server, &question).await;
    assert_eq!(
        (&answer["verdict"], &answer["places"][0]["map"]),
        (&json!("located"), &json!("floor-e")),
        "{answer}"
    );
}

#[tokio::test]
async fn views_tell_the_place_and_what_lies_in_one_session_is_no_rival() {
    let server = Server::start().await;
    let dense = |room| {
        let mut shot = Shot::of(room, pose([0.0; 3], 0.0));
        shot.points = 6 * POINTS;
        shot
    };
    let words = json!({"words": [1, 2], "weights": [1, 1]});
    for (map, room) in [("ninth", 1), ("tenth", 2)] {
        server.put(&format!("/v1/maps/{map}"), &json!({})).await.expect(201);
        server
            .put(&format!("/v1/maps/{map}/keyframes/a"), &dense(room).body("robot", true))
            .await
            .expect(201);
    }
    let asked = |room: u64, looks_like: u64| {
        let mut shot = Shot::of(room, query_pose()).looking_like(looks_like);
        shot.points = 6 * POINTS;
        let body = shot.body("nobody", true);
        json!({"camera": body["camera"], "bow": words, "features": body["features"],
            "map_points": {"ids": body["map_points"]["ids"],
                "positions": in_camera(&body["map_points"]["positions"], &query_pose())}})
    };
    let answer = locate(&server, &json!({"keyframe": asked(1, 1)})).await;
    assert_eq!(
        (&answer["verdict"], &answer["places"][0]["map"]),
        (&json!("located"), &json!("ninth")),
        "{answer}"
    );
    assert_eq!(answer["places"][0]["pose_source"], "views");
    let (metres, degrees) = off(&answer["places"][0]["map_from_camera"], &query_pose());
    assert!(metres < 0.05 && degrees < 1.0, "{answer}");
    // A second keyframe of the same place in the same map takes nothing away.
    let beside = Shot { world_from_camera: pose([0.1, 0.0, 0.0], 2.0), ..dense(1) };
    server.put("/v1/maps/ninth/keyframes/b", &beside.body("robot", true)).await.expect(201);
    assert_eq!(locate(&server, &json!({"keyframe": asked(1, 1)})).await["verdict"], "located");
    // The same room on another floor does.
    server.put("/v1/maps/tenth/keyframes/twin", &dense(1).body("other", true)).await.expect(201);
    let answer = locate(&server, &json!({"keyframe": asked(1, 1)})).await;
    assert_eq!(answer["verdict"], "ambiguous", "{answer}");
    // What the asker leaves out is neither place nor rival.
    for exclude in [json!({"sessions": ["other"]}), json!({"keyframes": ["twin", "unheard-of"]})] {
        let answer = locate(&server, &json!({"keyframe": asked(1, 1), "exclude": exclude})).await;
        assert_eq!(answer["verdict"], "located", "{answer}");
    }
    // Nowhere.
    let answer = locate(&server, &json!({"keyframe": asked(3, 3)})).await;
    assert_eq!(
        (&answer["verdict"], &answer["reason"]["code"]),
        (&json!("unknown"), &json!("too_little_evidence"))
    );
}

fn in_camera(positions: &Value, map_from_camera: &Pose) -> Value {
    let moved = positions.as_array().unwrap().iter().map(|position| {
        let position: [f64; 3] = serde_json::from_value(position.clone()).unwrap();
        let point = map_from_camera.inverse_transform(&position.into());
        json!([point.x, point.y, point.z])
    });
    Value::Array(moved.collect())
}

#[tokio::test]
async fn a_question_stores_nothing_and_its_answer_repeats_to_the_byte() {
    let directory = tempfile::tempdir().unwrap();
    let question =
        json!({"keyframe": sighted(&pose([0.1, 0.0, 2.0], 3.0), &CORRIDOR[1..3]), "maps": ["tow*"]});
    let mut answers = Vec::new();
    for _ in 0..2 {
        let server = Server::on(directory.path()).await;
        if answers.is_empty() {
            drive(&server, "tower", &CORRIDOR, None).await;
        }
        let before = server.get("/v1/maps/tower").await.expect(200);
        answers.push(locate(&server, &question).await);
        answers.push(locate(&server, &question).await);
        assert_eq!(server.get("/v1/maps/tower").await.expect(200), before);
        server.stop().await;
    }
    assert_eq!(answers[0]["verdict"], "located");
    assert!(answers.iter().all(|answer| *answer == answers[0]), "{answers:?}");
}

#[tokio::test]
async fn a_bad_question_is_refused_with_each_of_its_faults() {
    let server = Server::with_map("tower").await;
    let refusals = [
        (json!({}), 422, vec![""]),
        (json!({"keyframe": {}, "keyframes": [{}]}), 422, vec![""]),
        (json!({"keyframes": []}), 422, vec!["/keyframes"]),
        (json!({"keyframes": vec![json!({}); 17]}), 422, vec!["/keyframes"]),
        (
            json!({"keyframe": {"gravity": [0, 3, 0], "pose": 1, "nonsense": 1}, "max": 0, "maps": ["!"]}),
            422,
            vec!["/keyframe/gravity/1", "/keyframe/nonsense", "/keyframe/pose", "/maps/0", "/max"],
        ),
        (json!({"keyframe": {}, "hint": {"radius_m": 1}}), 422, vec!["/hint"]),
        (json!({"keyframe": {}, "maps": ["annex"]}), 404, vec![]),
    ];
    for (question, status, pointers) in refusals {
        let refused = server.post("/v1/locate", &question).await.expect(status);
        let mut found: Vec<&str> = refused["errors"]
            .as_array()
            .unwrap()
            .iter()
            .map(|error| error["pointer"].as_str().unwrap())
            .collect();
        found.sort_unstable();
        assert_eq!(found, pointers, "{question}: {refused}");
    }
    for number in 0..64 {
        server.put(&format!("/v1/maps/floor-{number}"), &json!({})).await.expect(201);
    }
    let refused = server.post("/v1/locate", &json!({"keyframe": {}})).await.expect(422);
    assert_eq!(refused["errors"][0]["pointer"], "/maps");
    let answer = server.post("/v1/locate", &json!({"keyframe": {}, "maps": ["floor-*"]})).await.expect(200);
    assert_eq!((&answer["verdict"], answer["maps"].as_array().unwrap().len()), (&json!("unknown"), 64));
    // A pattern that names nothing is no mistake, unlike a name.
    server.post("/v1/locate", &json!({"keyframe": {}, "maps": ["attic-*"]})).await.expect(200);
}

#[tokio::test]
async fn a_plan_alone_says_where_a_camera_is_and_an_aligned_session_says_it_in_the_plan_too() {
    let server = Server::start().await;
    server.put("/v1/maps/tower", &json!({})).await.expect(201);
    for (text, position) in CORRIDOR {
        // The plan's frame has z up, x along the corridor and its origin at the seventh metre.
        let [x, y, z] = position;
        let body = json!({"class": "door_number", "description": text, "frame": "plan:9",
            "position": [z - 7.0, -x, -y]});
        server.put(&format!("/v1/maps/tower/anchors/door-{text}"), &body).await.expect(201);
    }
    let camera = pose([0.3, 0.0, 1.0], 25.0);
    let question = json!({"keyframe": sighted(&camera, &CORRIDOR[..3])});
    let answer = locate(&server, &question).await;
    let place = &answer["places"][0];
    assert_eq!((&answer["verdict"], &place["session"]), (&json!("located"), &json!("plan:9")), "{answer}");
    assert_eq!((&place["keyframe"], &place["plan"]), (&Value::Null, &json!("plan:9")), "{answer}");
    assert_eq!(place["plan_from_camera"], place["map_from_camera"]);
    let centre = |place: &Value| {
        let at = &place["plan_from_camera"]["translation"];
        ["x", "y", "z"].map(|axis| at[axis].as_f64().unwrap())
    };
    let expected = [1.0 - 7.0, -0.3, 0.0];
    let off_m = |found: [f64; 3]| found.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(off_m(centre(place)) < 0.01, "{answer}");
    // A robot drives along the corridor: its session is aligned, and is no rival of the plan that shows the same.
    drive_on(&server, "tower", &CORRIDOR, None).await;
    let answer = locate(&server, &question).await;
    let place = &answer["places"][0];
    assert_eq!((&answer["verdict"], &place["session"]), (&json!("located"), &json!("robot")), "{answer}");
    assert!(place["keyframe"].is_string() && place["plan"] == "plan:9", "{answer}");
    assert!(off_m(centre(place)) < 0.05, "{answer}");
    let (metres, _) = off(&place["map_from_camera"], &camera);
    assert!(metres < 0.01, "{answer}");
}

#[tokio::test]
async fn a_key_is_located_in_its_own_maps_only() {
    let server = Server::start().await;
    for map in ["ninth", "tenth"] {
        drive(&server, map, &CORRIDOR, None).await;
    }
    let root = server.post("/v1/keys", &json!({"actions": ["admin"]})).await.expect(201);
    let made = server
        .request(Method::POST, "/v1/keys")
        .bearer_auth(root["secret"].as_str().unwrap())
        .json(&json!({"actions": ["query"], "maps": ["nin*"]}));
    let made = Answer::of(made).await.expect(201);
    let ask = async |maps: Value| {
        let mut question = json!({"keyframe": sighted(&pose([0.3, 0.0, 1.0], 5.0), &CORRIDOR[..3])});
        if !maps.is_null() {
            question["maps"] = maps;
        }
        let asked = server.request(Method::POST, "/v1/locate").bearer_auth(made["secret"].as_str().unwrap());
        Answer::of(asked.json(&question)).await
    };
    for maps in [Value::Null, json!(["*"])] {
        let answer = ask(maps).await.expect(200);
        // With the tenth floor it would be ambiguous.
        assert_eq!(
            (&answer["verdict"], answer["maps"].as_array().unwrap().len()),
            (&json!("located"), 1),
            "{answer}"
        );
    }
    ask(json!(["tenth"])).await.expect(404);
}
