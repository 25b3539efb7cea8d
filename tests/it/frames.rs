//! One frame for a fleet over HTTP: robots that met in planted rooms.

use reqwest::Method;
use revisit::geometry::Pose;
use serde_json::{Value, json};

use crate::geometry::scene::{Shot, number, off, pose, query_pose, store};
use crate::support::{Answer, Server};

const MAP: &str = "/v1/maps/m";

/// Stores a room as robot a sees it, and as robot b does, whose frame lies there; confirms the loop that is found.
async fn meet(server: &Server, room: u64, b_from_world: Pose) {
    let mut shots = [Shot::of(room, Pose::identity()), Shot::of(room, query_pose())];
    shots[1].session_from_world = b_from_world;
    for (robot, shot) in ["a", "b"].into_iter().zip(&shots) {
        let mut body = shot.body(robot, true);
        body["stamp"] = json!({"sec": room, "nanosec": 0});
        // Each room has points of its own.
        for path in ["/map_points/ids", "/features/map_points"] {
            for id in body.pointer_mut(path).and_then(Value::as_array_mut).expect("points") {
                *id = json!(id.as_u64().expect("a number") + 1000 * room);
            }
        }
        store(server, &format!("{robot}-{room}"), &body).await;
    }
    let asked = json!({"keyframe": format!("b-{room}"), "verify": "geometry"});
    let answer = server.post(&format!("{MAP}/loop-queries"), &asked).await.expect(200);
    assert_eq!(answer["best"], format!("a-{room}"), "{answer:#}");
    let closed = json!({"id": format!("loop-{room}"), "keyframe": format!("b-{room}"),
        "candidate": format!("a-{room}"), "query": answer["id"]});
    server.post(&format!("{MAP}/loops"), &closed).await.expect(201);
}

async fn frames(server: &Server) -> Value {
    server.get(&format!("{MAP}/frames")).await.expect(200)
}

#[tokio::test]
async fn two_robots_that_met_are_in_one_frame_and_a_false_loop_is_a_suspect() {
    let folder = tempfile::tempdir().unwrap();
    let server = Server::on(folder.path()).await;
    server
        .put(MAP, &json!({"settings": {"without_anchors": "geometry", "building_repeats": false}}))
        .await
        .expect(201);
    let b_from_world = pose([10.0, -3.0, 2.0], 70.0);
    meet(&server, 1, b_from_world).await;
    meet(&server, 2, b_from_world).await;
    let met = frames(&server).await;
    assert_eq!((&met["reference"], &met["loops"], &met["left_out"]), (&json!("a"), &json!(2), &json!(0)));
    let b = &met["frames"][1];
    let (metres, degrees) = off(&b["reference_from_session"], &b_from_world.inverse());
    assert!(metres < 0.05 && degrees < 0.2, "{metres} m, {degrees} degrees: {met:#}");
    assert!(number(&b["residual"]) < 0.05 && b["loops"] == 2, "{b:#}");

    // In room 3 robot b believes itself five metres further on. Another loop has no transformation.
    meet(&server, 3, pose([15.0, -3.0, 2.0], 70.0)).await;
    let unknown = json!({"id": "unknown", "keyframe": "b-1", "candidate": "a-3"});
    server.post(&format!("{MAP}/loops"), &unknown).await.expect(201);
    let contradicted = frames(&server).await;
    assert_eq!(contradicted["left_out"], 1);
    let suspect = &contradicted["suspects"][0];
    assert_eq!((&suspect["loop"], suspect["cycle"].as_array().map(Vec::len)), (&json!("loop-3"), Some(1)));
    assert!((number(&suspect["residual"]) - 5.0).abs() < 0.1, "{suspect:#}");
    let (metres, _) = off(&contradicted["frames"][1]["reference_from_session"], &b_from_world.inverse());
    assert!(metres < 0.05, "{metres} m: {contradicted:#}");
    let is_told = |event: &Value| event["event"] == "loop_suspected" && event["loop"] == "loop-3";
    server.event(&format!("{MAP}/events?since=0"), is_told).await;

    // The same bytes again, and after a restart.
    let text =
        async |server: &Server| Answer::text(server.request(Method::GET, &format!("{MAP}/frames"))).await;
    let before = text(&server).await;
    assert_eq!(text(&server).await, before);
    server.stop().await;
    let server = Server::on(folder.path()).await;
    assert_eq!(text(&server).await, before);

    // Whoever reads the frames reads those of the map as it is, also while the server brings them up to date by itself.
    let loop_3 = json!({"id": "loop-3", "keyframe": "b-3", "candidate": "a-3",
        "query": server.get(&format!("{MAP}/loops")).await.expect(200)["items"][2]["query"]});
    for _ in 0..20 {
        server.delete(&format!("{MAP}/loops/loop-3")).await.expect(200);
        assert_eq!(frames(&server).await["suspects"], json!([]));
        server.post(&format!("{MAP}/loops"), &loop_3).await.expect(201);
        assert_eq!(frames(&server).await["suspects"][0]["loop"], "loop-3");
    }

    let asked = server.get(&format!("{MAP}/frames?reference=nobody")).await;
    assert_eq!(asked.pointers(), ["?reference"]);
}

#[tokio::test]
async fn the_trajectory_of_the_fleet_has_both_robots_in_the_frame_of_one() {
    let server = Server::with_map("m").await;
    server
        .patch(MAP, &json!({"settings": {"without_anchors": "geometry", "building_repeats": false}}))
        .await
        .expect(200);
    let b_from_world = pose([10.0, -3.0, 2.0], 70.0);
    meet(&server, 1, b_from_world).await;
    meet(&server, 2, b_from_world).await;
    let tum = async |query: &str| {
        let text =
            Answer::text(server.request(Method::GET, &format!("{MAP}/trajectory?format=tum{query}"))).await;
        let numbers =
            |line: &str| line.split(' ').map(|n| n.parse().expect("a number")).collect::<Vec<f64>>();
        text.lines().filter(|line| !line.starts_with('#')).map(numbers).collect::<Vec<_>>()
    };
    let all = tum("&frame=fleet").await;
    assert_eq!(all.iter().map(|line| line[0]).collect::<Vec<_>>(), [1.0, 2.0, 1.0, 2.0], "a, then b");
    // In the world, which is the frame of a, b stood where its camera was planted.
    let planted = query_pose().translation_m();
    let of_b = tum("&frame=fleet&session=b").await;
    assert_eq!(of_b.len(), 2);
    for line in of_b {
        let off: f64 = (0..3).map(|axis| (line[1 + axis] - planted[axis]).powi(2)).sum();
        assert!(off.sqrt() < 0.05, "{line:?}, planted at {planted:?}");
    }
    let from_b = tum("&frame=fleet&reference=b&session=b").await;
    assert_eq!(from_b, tum("&session=b").await);
}

#[tokio::test]
async fn a_suspect_is_revoked_where_the_map_says_so() {
    let server = Server::start().await;
    let settings = json!({"without_anchors": "geometry", "building_repeats": false, "revoke_suspects": true});
    server.put(MAP, &json!({"settings": settings})).await.expect(201);
    let b_from_world = pose([10.0, -3.0, 2.0], 70.0);
    meet(&server, 1, b_from_world).await;
    meet(&server, 2, b_from_world).await;
    meet(&server, 3, pose([15.0, -3.0, 2.0], 70.0)).await;
    let is_told = |event: &Value| event["event"] == "loop_revoked" && event["loop"] == "loop-3";
    server.event(&format!("{MAP}/events?since=0"), is_told).await;
    let left = server.get(&format!("{MAP}/loops")).await.expect(200);
    let ids: Vec<&Value> = left["items"].as_array().unwrap().iter().map(|of| &of["id"]).collect();
    assert_eq!(ids, ["loop-1", "loop-2"]);
    assert_eq!(frames(&server).await["suspects"], json!([]));
}

#[tokio::test]
async fn a_loop_with_the_clients_own_transformation_joins_robots_and_goes_with_an_export() {
    let server = Server::start().await;
    server.put(MAP, &json!({})).await.expect(201);
    for (robot, sec) in [("a", 1), ("b", 2)] {
        let mut body = crate::support::keyframe();
        (body["session"], body["stamp"]["sec"]) = (json!(robot), json!(sec));
        server.put(&format!("{MAP}/keyframes/{robot}-1"), &body).await.expect(201);
    }
    let planted = pose([1.0, 2.0, 3.0], 30.0);
    let ([x, y, z], [qx, qy, qz, qw]) = (planted.translation_m(), planted.rotation_xyzw());
    let said =
        json!({"translation": {"x": x, "y": y, "z": z}, "rotation": {"x": qx, "y": qy, "z": qz, "w": qw}});
    let mut closed =
        json!({"id": "own", "keyframe": "b-1", "candidate": "a-1", "candidate_from_query": said});
    server.post(&format!("{MAP}/loops"), &closed).await.expect(201);
    server.post(&format!("{MAP}/loops"), &closed).await.expect(200);
    closed["candidate_from_query"]["translation"]["x"] = json!(2.0);
    server.post(&format!("{MAP}/loops"), &closed).await.expect(409);
    let joined = frames(&server).await;
    assert_eq!((&joined["loops"], &joined["left_out"]), (&json!(1), &json!(0)), "{joined:#}");
    let (metres, degrees) = off(&joined["frames"][1]["reference_from_session"], &planted);
    assert!(metres < 1e-6 && degrees < 1e-6, "{metres} m, {degrees} degrees: {joined:#}");

    // A copy of the map is joined alike.
    let lines = crate::exports::exported(&server, "m").await;
    let of_loop = lines.iter().find(|line| line["op"] == "loop").unwrap();
    let copy = Server::start().await;
    copy.put(MAP, &json!({})).await.expect(201);
    for line in lines.iter().filter(|line| line["op"] == "keyframe") {
        let path = format!("{MAP}/keyframes/{}", line["id"].as_str().unwrap());
        copy.put(&path, &line["body"]).await.expect(201);
    }
    copy.post(&format!("{MAP}/loops"), &of_loop["body"]).await.expect(201);
    assert_eq!(frames(&copy).await["frames"], joined["frames"]);
    closed["candidate_from_query"]["rotation"]["w"] = json!(0.5);
    closed["id"] = json!("bent");
    let refused = server.post(&format!("{MAP}/loops"), &closed).await;
    assert_eq!(refused.pointers(), ["/candidate_from_query/rotation"]);
}
