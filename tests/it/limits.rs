//! Limits: what is too slow, too large or too much is refused, and the others go on.

use std::io::{Read as _, Write as _};

use reqwest::Method;
use revisit::engine::limits::load_shedding::{Kind, RequestPermit};
use serde_json::{Value, json};

use crate::raw::{Connection, statuses};
use crate::support::{Answer, Server, keyframe};

const MAP: &str = "/v1/maps/m";
const HEALTH: &str = "GET /healthz HTTP/1.1\r\nhost: localhost\r\n\r\n";

async fn with_map(limits: &[&str]) -> (Server, revisit::engine::Service) {
    let (server, service) = Server::within(limits).await;
    server.put(MAP, &json!({})).await.expect(201);
    (server, service)
}

#[tokio::test]
async fn a_head_that_does_not_arrive_is_not_waited_for() {
    let (server, _) = Server::within(&["--header-timeout", "0.2"]).await;
    for sent in ["", "GET", "GET /healthz HTTP/1.1\r\nhost: localhost\r\n"] {
        let mut connection = Connection::open(server.addr()).await;
        connection.send(sent).await;
        assert_eq!(connection.rest().await, "", "{sent:?}");
    }
    // Neither is a second one.
    let mut connection = Connection::open(server.addr()).await;
    connection.send(HEALTH).await;
    assert!(connection.head().await.contains("200 OK"));
    connection.send("GET /heal").await;
    assert_eq!(statuses(&connection.rest().await), Vec::<u16>::new());
}

#[tokio::test]
async fn an_idle_connection_is_closed_in_time_and_not_before() {
    let (server, _) = Server::within(&["--header-timeout", "0.1", "--keep-alive", "0.6"]).await;
    let mut connection = Connection::open(server.addr()).await;
    for _ in 0..3 {
        connection.send(HEALTH).await;
        assert!(connection.head().await.contains("200 OK"));
        // Longer than a head may take.
        tokio::time::sleep(std::time::Duration::from_millis(200)).await;
    }
    assert_eq!(connection.rest().await, "");
}

#[tokio::test]
async fn a_body_that_trickles_is_given_up_and_told_so() {
    let (server, _) = with_map(&["--header-timeout", "0.2"]).await;
    for path in [format!("PUT {MAP}/keyframes/kf-1"), format!("POST {MAP}/loop-queries")] {
        let mut connection = Connection::open(server.addr()).await;
        let head = format!("{path} HTTP/1.1\r\nhost: localhost\r\ncontent-length: 100000\r\n\r\n{{");
        connection.send(head).await;
        let answer = connection.rest().await;
        assert_eq!(statuses(&answer), [408], "{answer}");
        assert!(answer.contains(r#""code":"timeout""#), "{answer}");
    }
    // A bulk tells it in its last line.
    let mut connection = Connection::open(server.addr()).await;
    let head =
        format!("POST {MAP}/keyframes HTTP/1.1\r\nhost: localhost\r\ncontent-length: 100000\r\n\r\n{{");
    connection.send(head).await;
    let answer = connection.rest().await;
    assert_eq!(statuses(&answer), [207], "{answer}");
    assert!(answer.contains(r#""code":"timeout""#), "{answer}");
}

#[tokio::test]
async fn evicts_the_longest_idle_connection_when_all_slots_are_taken() {
    let (server, _) = Server::within(&["--max-connections", "2"]).await;
    let mut first = Connection::open(server.addr()).await;
    first.send(HEALTH).await;
    assert!(first.head().await.contains("200 OK"));
    let mut second = Connection::open(server.addr()).await;
    second.send(HEALTH).await;
    assert!(second.head().await.contains("200 OK"));
    let mut third = Connection::open(server.addr()).await;
    third.send(HEALTH).await;
    assert!(third.head().await.contains("200 OK"));
    assert_eq!(first.rest().await, "", "the first has waited longest");
    second.send(HEALTH).await;
    assert!(second.head().await.contains("200 OK"), "the second has its seat still");
}

#[tokio::test]
async fn a_newcomer_is_told_to_come_back_when_all_slots_are_busy() {
    let (server, _) = Server::within(&["--max-connections", "1"]).await;
    let mut stream = Connection::open(server.addr()).await;
    let body = "{}";
    stream
        .send(format!("PUT {MAP} HTTP/1.1\r\nhost: localhost\r\ncontent-type: application/json\r\ncontent-length: 2\r\n\r\n{body}"))
        .await;
    assert!(stream.head().await.contains("201 Created"));
    stream.send(format!("GET {MAP}/events HTTP/1.1\r\nhost: localhost\r\n\r\n")).await;
    assert!(stream.head().await.contains("text/event-stream"));
    let mut newcomer = Connection::open(server.addr()).await;
    newcomer.send(HEALTH).await;
    let answer = newcomer.rest().await;
    assert_eq!(statuses(&answer), [503], "{answer}");
    assert!(answer.contains("retry-after: 1\r\n") && answer.contains(r#""code":"overloaded""#), "{answer}");
    // The stream is still there, and ends with the server.
    server.stop().await;
    let end = stream.rest().await;
    assert!(end.ends_with("0\r\n\r\n"), "the stream was cut off: {end:?}");
}

/// So many requests are being worked on.
fn work(service: &revisit::engine::Service, kind: Kind, count: usize) -> Vec<RequestPermit> {
    (0..count).map(|_| service.pressure().admit(kind).expect("room")).collect()
}

#[tokio::test]
async fn under_pressure_reads_are_refused_first_then_writes_and_health_never() {
    let (server, service) = with_map(&["--max-requests", "8"]).await;
    let put = async |id: &str| server.put_keyframe(&format!("{MAP}/keyframes/{id}")).await;
    let ask = json!({"keyframe": "kf-1"});

    let turns = work(&service, Kind::Read, 6);
    refused(&server.get(MAP).await);
    refused(&server.post(&format!("{MAP}/loop-queries"), &ask).await);
    put("kf-1").await.expect(201);

    let more = work(&service, Kind::Write, 2);
    refused(&put("kf-2").await);
    refused(&server.delete(MAP).await);
    let large = vec![b' '; 900_000];
    refused(&server.send(Method::PUT, &format!("{MAP}/keyframes/kf-3"), "application/json", large).await);
    for always in ["/healthz", "/readyz"] {
        server.get(always).await.expect(200);
    }
    let metrics = Answer::text(server.request(Method::GET, "/metrics")).await;
    for line in [
        r#"revisit_shed_total{what="read"} 2"#,
        r#"revisit_shed_total{what="write"} 3"#,
        "revisit_requests_in_flight 8",
    ] {
        assert!(metrics.contains(line), "{line}\n{metrics}");
    }

    drop((turns, more));
    // Writes take three quarters at most: they keep no question out.
    let turns = work(&service, Kind::Write, 6);
    refused(&put("kf-2").await);
    server.post(&format!("{MAP}/loop-queries"), &ask).await.expect(200);
    drop(turns);
    put("kf-2").await.expect(201);
    server.get(&format!("{MAP}/keyframes/kf-3")).await.expect(404);
    server.post(&format!("{MAP}/loop-queries"), &ask).await.expect(200);
}

#[track_caller]
fn refused(answer: &Answer) {
    assert_eq!((answer.status.as_u16(), &answer.body["code"]), (503, &json!("overloaded")), "{answer:#?}");
    assert_eq!(answer.header("retry-after"), "1", "{answer:#?}");
}

#[tokio::test]
async fn a_body_on_its_way_counts_for_nothing() {
    let (server, _) = with_map(&["--max-requests", "1"]).await;
    let mut slow = Connection::open(server.addr()).await;
    let body = keyframe().to_string();
    let length = body.len();
    slow.send(format!("PUT {MAP}/keyframes/kf-1 HTTP/1.1\r\nhost: localhost\r\ncontent-length: {length}\r\nexpect: 100-continue\r\n\r\n"))
        .await;
    // That it is asked for its body means that the server waits for it.
    assert!(slow.head().await.contains("100 Continue"));
    server.put(&format!("{MAP}/keyframes/kf-2"), &keyframe()).await.expect(201);
    slow.send(body).await;
    assert!(slow.head().await.contains("201 Created"));
}

#[tokio::test]
async fn large_bodies_share_a_memory_and_small_ones_pass() {
    let (server, _) = with_map(&["--max-body-memory", "1"]).await;
    let path = format!("{MAP}/keyframes/kf-1");
    let mut large = keyframe();
    large["map_points"] =
        json!({"ids": (0..20_000).collect::<Vec<u32>>(), "positions": vec![[1.5, 2.5, 3.5]; 20_000]});
    refused(&server.put(&path, &large).await);
    server.put(&path, &keyframe()).await.expect(201);
    let metrics = Answer::text(server.request(Method::GET, "/metrics")).await;
    assert!(metrics.contains(r#"revisit_shed_total{what="body"} 1"#), "{metrics}");
}

fn gzip(text: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    encoder.write_all(text).unwrap();
    encoder.finish().unwrap()
}

fn zstd(text: &[u8]) -> Vec<u8> {
    zstd::encode_all(text, 1).unwrap()
}

/// A frame that says it looks back so far.
fn zstd_wide(text: &[u8], window_log: u32) -> Vec<u8> {
    let mut encoder = zstd::stream::write::Encoder::new(Vec::new(), 1).unwrap();
    encoder.window_log(window_log).unwrap();
    encoder.write_all(text).unwrap();
    encoder.finish().unwrap()
}

#[tokio::test]
async fn compressed_bodies_are_read_and_bombs_are_not() {
    let (server, _) = with_map(&[]).await;
    let path = |id: &str| format!("{MAP}/keyframes/{id}");
    let body = keyframe().to_string().into_bytes();
    let (front, back) = body.split_at(body.len() / 2);
    let zeros = |count: usize| std::io::repeat(b' ').take(count as u64);
    let spaces = |count: usize| {
        let mut all = Vec::new();
        zeros(count).read_to_end(&mut all).unwrap();
        all
    };
    let list = [b"{\"observes\":[".as_slice(), &b"0,".repeat(1_500_000), b"0]}"].concat();
    let rows = [b"{\"observes\":[".as_slice(), &b"[0,0,0,0],".repeat(180_000), b"0]}"].concat();
    let cases: Vec<(&str, &str, Vec<u8>, u16)> = vec![
        ("gzip", "gzip", gzip(&body), 201),
        ("x-gzip", "x-gzip", gzip(&body), 201),
        ("zstd", "zstd", zstd(&body), 201),
        ("identity", "identity", body.clone(), 201),
        ("two members", "gzip", [gzip(front), gzip(back)].concat(), 201),
        ("two frames", "zstd", [zstd(front), zstd(back)].concat(), 201),
        ("a window of 8 MiB", "zstd", zstd_wide(&body, 23), 201),
        ("a window of 128 MiB", "zstd", zstd_wide(&body, 27), 400),
        ("half of it", "gzip", gzip(&body)[..40].to_vec(), 400),
        ("gzip in gzip, told", "gzip, gzip", gzip(&gzip(&body)), 415),
        ("gzip in gzip, not told", "gzip", gzip(&gzip(&body)), 400),
        ("33 MB of gzip", "gzip", gzip(&spaces(33 << 20)), 413),
        ("200 MB of zstd", "zstd", zstd(&spaces(200 << 20)), 413),
        ("30 MB of gzip, valid but for its emptiness", "gzip", gzip(&spaces(30 << 20)), 413),
        ("many members", "gzip", gzip(&spaces(1 << 20)).repeat(100), 413),
        ("a long list", "gzip", gzip(&list), 413),
        ("many short lists", "zstd", zstd(&rows), 413),
        ("a text", "zstd", zstd(&[b"{\"session\":\"".as_slice(), &spaces(3 << 20), b"\"}"].concat()), 413),
    ];
    for (what, encoding, bytes, status) in cases {
        let id = what.replace([' ', ','], "-");
        let request = server.request(Method::PUT, &path(&id)).header("content-encoding", encoding);
        let answer = Answer::of(request.header("content-type", "application/json").body(bytes)).await;
        assert_eq!(answer.status, status, "{what}: {answer:#?}");
    }
    let twice = server.request(Method::PUT, &path("twice")).header("content-encoding", "gzip");
    let twice = twice.header("content-encoding", "gzip").body(gzip(&gzip(&body)));
    assert_eq!(Answer::of(twice).await.status, 415);
}

#[tokio::test]
async fn a_bulk_passes_over_its_bombs_and_stores_the_rest() {
    let (server, _) = with_map(&[]).await;
    let line = |id: &str| {
        let mut item = keyframe();
        item["id"] = json!(id);
        format!("{item}\n")
    };
    let long = " ".repeat(20 << 20);
    let deep = "[".repeat(1 << 20);
    let wide = format!("{{\"id\":\"kf-w\",\"observes\":[{}0]}}", "0,".repeat(1_500_000));
    for (encoding, compress) in
        [("gzip", gzip as fn(&[u8]) -> Vec<u8>), ("zstd", zstd), ("identity", <[u8]>::to_vec)]
    {
        let (first, last) = (line(&format!("{encoding}-1")), line(&format!("{encoding}-2")));
        let text = format!("{first}{long}\n{deep}\n{wide}\n{last}");
        let request =
            server.request(Method::POST, &format!("{MAP}/keyframes")).header("content-encoding", encoding);
        let request = request.header("content-type", "application/x-ndjson").body(compress(text.as_bytes()));
        let answer = Answer::text(request).await;
        let lines: Vec<Value> = answer.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
        let statuses: Vec<&Value> = lines.iter().map(|line| &line["status"]).collect();
        assert_eq!(statuses, [201, 413, 400, 413, 201], "{encoding}: {answer}");
    }
}

#[tokio::test]
async fn a_bulk_of_nonsense_does_not_fill_the_memory_with_its_answer() {
    let (server, _) = with_map(&[]).await;
    let text = "{}\n".repeat(100_000);
    let request = server.request(Method::POST, &format!("{MAP}/keyframes"));
    let request = request.header("content-type", "application/x-ndjson").body(text);
    let answer = Answer::text(request).await;
    assert!(answer.len() < 5 << 20, "{} bytes", answer.len());
    let last: Value = serde_json::from_str(answer.lines().last().unwrap()).unwrap();
    assert!(last.to_string().contains("too many lines were rejected"), "{last}");
}

#[tokio::test]
async fn one_key_cannot_take_every_seat_with_streams() {
    // A quarter of the connections, or what the operator says.
    for flags in [&["--max-connections", "8"][..], &["--max-connections", "8", "--max-streams", "2"]] {
        let (server, _) = with_map(flags).await;
        let events = format!("{MAP}/events");
        let listen = async |secret: Option<&str>| {
            let request = server.request(Method::GET, &events);
            let request = secret.into_iter().fold(request, reqwest::RequestBuilder::bearer_auth);
            request.send().await.expect("an answer")
        };
        let open = [listen(None).await, listen(None).await];
        assert!(open.iter().all(|stream| stream.status() == 200));
        assert_eq!(listen(None).await.status(), 503, "{flags:?}");
        refused(&server.get(&events).await);
        let [gone, _kept] = open;
        drop(gone);
        // The server sees that its client is gone, and gives the place to another.
        let again = loop {
            let again = listen(None).await;
            if again.status() == 200 {
                break again;
            }
        };
        drop(again);

        let root = server.post("/v1/keys", &json!({"actions": ["read", "admin"]})).await.expect(201);
        let root = root["secret"].as_str().expect("a secret");
        let body = json!({"actions": ["read"]});
        let made = Answer::of(server.request(Method::POST, "/v1/keys").bearer_auth(root).json(&body)).await;
        let made = made.expect(201);
        let other = made["secret"].as_str().expect("a secret");
        let open = [listen(Some(root)).await, listen(Some(root)).await];
        assert!(open.iter().all(|stream| stream.status() == 200));
        assert_eq!(listen(Some(root)).await.status(), 429, "{flags:?}");
        let third = Answer::of(server.request(Method::GET, &events).bearer_auth(root)).await;
        assert_eq!((third.header("retry-after"), &third.body["code"]), ("1", &json!("too_many_requests")));
        third.expect(429);
        assert_eq!(listen(Some(other)).await.status(), 200, "what one key has is not the other's affair");
        server.get("/healthz").await.expect(200);
        Answer::of(server.request(Method::GET, MAP).bearer_auth(root)).await.expect(200);
    }
}

#[tokio::test]
async fn strangers_that_come_by_hundreds_take_no_place_of_those_who_are_known() {
    let (server, _) = Server::within(&["--max-requests", "4"]).await;
    let made = server.post("/v1/keys", &json!({"actions": ["read", "admin"]})).await.expect(201);
    let known = made["secret"].as_str().expect("a secret");
    let ask = async |secret: &str, status: u16| {
        Answer::of(server.request(Method::GET, "/v1/maps").bearer_auth(secret)).await.expect(status);
    };
    let strangers = (0..200).map(async |_| ask("nonsense", 401).await);
    let one_who_is_known = async {
        for _ in 0..20 {
            ask(known, 200).await;
        }
    };
    futures_util::future::join(futures_util::future::join_all(strangers), one_who_is_known).await;
}
