//! Trajectories: what evo, g2o and gtsam read of a map.

use reqwest::{Method, StatusCode};
use serde_json::json;

use crate::support::{Answer, Server, pose};

async fn put(server: &Server, id: &str, session: &str, seconds: i64, x: f64) {
    let body =
        json!({"session": session, "stamp": {"sec": seconds, "nanosec": 5}, "pose": pose([x, 0.0, 0.0])});
    server.put(&format!("/v1/maps/m/keyframes/{id}"), &body).await.expect(201);
}

async fn text(server: &Server, query: &str) -> String {
    Answer::text(server.request(Method::GET, &format!("/v1/maps/m/trajectory{query}"))).await
}

#[tokio::test(flavor = "multi_thread")]
async fn a_trajectory_is_in_order_of_time_as_last_corrected_and_without_what_was_culled() {
    let server = Server::with_map("m").await;
    assert_eq!(text(&server, "?format=kitti").await, "");
    // Sent late, seen early.
    for (id, seconds, x) in [("k-3", 3, 3.0), ("k-1", 1, 1.0), ("k-2", 2, 2.0), ("culled", 4, 4.0)] {
        put(&server, id, "s-1", seconds, x).await;
    }
    server.delete("/v1/maps/m/keyframes/culled").await.expect(200);
    let corrected =
        json!({"session": "s-1", "keyframes": {"ids": ["k-3"], "poses": [pose([3.5, 0.0, 0.0])]}});
    server.post("/v1/maps/m/poses", &corrected).await.expect(200);
    let lines = "# timestamp tx ty tz qx qy qz qw\n1.000000005 1 0 0 0 0 0 1\n2.000000005 2 0 0 0 0 0 1\n3.000000005 3.5 0 0 0 0 0 1\n";
    assert_eq!(text(&server, "?format=tum").await, lines);
    assert_eq!(text(&server, "?format=tum&session=s-1").await, lines);
    assert_eq!(text(&server, "?format=kitti").await.lines().next(), Some("1 0 0 1 0 1 0 0 0 0 1 0"));

    let answer = server.get("/v1/maps/m/trajectory?format=tum").await;
    assert_eq!(answer.header("content-type"), "text/plain; charset=utf-8");
}

#[tokio::test(flavor = "multi_thread")]
async fn several_sessions_are_one_graph_but_not_one_trajectory() {
    let server = Server::with_map("m").await;
    for (id, session, seconds) in [("a", "s-1", 1), ("b", "s-1", 2), ("c", "s-2", 9)] {
        put(&server, id, session, seconds, f64::from(id.as_bytes()[0])).await;
    }
    let closed = json!({"id": "l-1", "keyframe": "c", "candidate": "a", "query": "nobody-knows"});
    server.post("/v1/maps/m/loops", &closed).await.expect(201);
    let graph = text(&server, "?format=g2o").await;
    let count = |tag: &str| graph.lines().filter(|line| line.starts_with(tag)).count();
    assert_eq!((count("VERTEX_SE3:QUAT "), count("EDGE_SE3:QUAT "), count("FIX ")), (3, 1, 1), "{graph}");
    assert!(graph.contains("# loop l-1 from a to c: no transformation is kept of it"), "{graph}");
    assert_eq!(
        text(&server, "?format=g2o&session=s-2").await.lines().filter(|line| !line.starts_with('#')).count(),
        2
    );

    for format in ["tum", "kitti"] {
        let refused = server.get(&format!("/v1/maps/m/trajectory?format={format}")).await;
        assert_eq!(
            (refused.status, refused.pointers()),
            (StatusCode::UNPROCESSABLE_ENTITY, vec!["?session"]),
            "{refused:?}"
        );
        assert_eq!(
            text(&server, &format!("?format={format}&session=s-2"))
                .await
                .lines()
                .filter(|line| !line.starts_with('#'))
                .count(),
            1
        );
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn rejects_queries_that_cannot_be_meant() {
    let server = Server::with_map("m").await;
    for (query, status, pointer) in [
        ("", 422, "?format"),
        ("?format=gpx", 422, "?format"),
        ("?format=tum&session=a%20b", 422, "?session"),
        ("?format=tum&frame=moon", 422, "?frame"),
        ("?format=tum&frame=fleet&reference=nobody", 422, "?reference"),
    ] {
        let refused = server.get(&format!("/v1/maps/m/trajectory{query}")).await;
        assert_eq!(
            (refused.status.as_u16(), refused.pointers()),
            (status, vec![pointer]),
            "{query}: {refused:?}"
        );
    }
    server.get("/v1/maps/m/trajectory?format=tum&session=s-9").await.expect(404);
    server.get("/v1/maps/nowhere/trajectory?format=tum").await.expect(404);
}
