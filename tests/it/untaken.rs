//! Untaken: answers that their clients do not take hold no memory for long.

use reqwest::Method;
use serde_json::json;
use tokio::io::{AsyncReadExt as _, AsyncWriteExt as _};
use tokio::net::TcpSocket;

use crate::support::{Answer, Server, keyframe};

const MAP: &str = "/v1/maps/m";

#[tokio::test(flavor = "multi_thread")]
async fn a_client_that_takes_nothing_makes_room_for_one_that_does() {
    let (server, _) = Server::within(&["--max-answer-memory", "1"]).await;
    server.put(MAP, &json!({})).await.expect(201);
    let mut large = keyframe();
    let places: Vec<[f64; 3]> = (0..20_000).map(|at| [f64::from(at) + 0.123_456_789, 2.5, 3.5]).collect();
    large["map_points"] = json!({"ids": (0..20_000).collect::<Vec<u32>>(), "positions": places});
    let path = format!("{MAP}/keyframes/kf-1");
    server.put(&path, &large).await.expect(201);

    // Its window is so small that most of the answer stays with the server.
    let socket = TcpSocket::new_v4().unwrap();
    socket.set_recv_buffer_size(4096).unwrap();
    let mut idle = socket.connect(server.addr()).await.unwrap();
    // More than the buffers of the kernel take.
    let many = format!("GET {path} HTTP/1.1\r\nhost: localhost\r\n\r\n").repeat(30);
    idle.write_all(many.as_bytes()).await.unwrap();

    let length = loop {
        let answer = server.get(&path).await;
        if answer.status == 200 {
            let metrics = Answer::text(server.request(Method::GET, "/metrics")).await;
            if metrics.contains("revisit_connections_total{fate=\"evicted\"} 1") {
                break answer.header("content-length").parse::<usize>().unwrap();
            }
        } else {
            assert_eq!((answer.status.as_u16(), answer.header("retry-after")), (503, "1"), "{answer:#?}");
            assert_eq!(answer.body["code"], "overloaded");
        }
    };
    assert!(length > 600_000, "{length}");
    let mut rest = Vec::new();
    // Whether it ends or is reset, it ends early.
    let _ = idle.read_to_end(&mut rest).await;
    assert!(rest.len() < 30 * length, "{} bytes", rest.len());
    server.get(MAP).await.expect(200);
}
