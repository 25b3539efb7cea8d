//! Several servers over one PostgreSQL database, in a database of its own for each test.

use std::net::SocketAddr;
use std::path::Path;
use std::time::{Duration, Instant};

use reqwest::{Method, StatusCode};
use serde_json::{Value, json};
use sqlx::{Connection as _, PgConnection};
use tokio::net::TcpSocket;

use crate::support::{Answer, Server, keyframe, postgres_of};

/// Longer than a lease lasts, with the time to notice it.
const OWNERS_SETTLE: Duration = Duration::from_secs(40);

const MAPS: usize = 12;

fn path(number: usize) -> String {
    format!("/v1/maps/m-{number}")
}

/// A keyframe that no other is like.
fn shot(number: usize) -> Value {
    let mut body = keyframe();
    body["stamp"] = json!({"sec": number, "nanosec": 0});
    body
}

/// Sends a request until it is answered by a server that has the map: it comes and goes when servers do.
async fn settled(server: &Server, method: Method, path: &str, body: Option<&Value>) -> Answer {
    let begun = Instant::now();
    loop {
        let request = server.request(method.clone(), path);
        let answer = Answer::of(match body {
            Some(body) => request.json(body),
            None => request,
        });
        let answer = answer.await;
        if answer.status != StatusCode::SERVICE_UNAVAILABLE {
            return answer;
        }
        assert!(answer.headers.contains_key("retry-after"), "{answer:#?}");
        assert!(begun.elapsed() < OWNERS_SETTLE, "no server has the map: {answer:#?}");
        tokio::time::sleep(Duration::from_millis(50)).await;
    }
}

async fn settled_put(server: &Server, path: &str, body: &Value) -> Value {
    let answer = settled(server, Method::PUT, path, Some(body)).await;
    assert!(answer.status.is_success(), "{path}: {answer:#?}");
    answer.body
}

/// The owners of the maps, as a server names them.
async fn owners(server: &Server) -> Vec<String> {
    let mut owners = Vec::new();
    for number in 0..MAPS {
        let answer = settled(server, Method::GET, &path(number), None).await;
        assert_eq!(answer.status, 200, "{answer:#?}");
        owners.push(answer.header("x-revisit-owner").to_owned());
    }
    owners
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs REVISIT_TEST_POSTGRES"]
async fn any_of_two_servers_answers_for_every_map_and_each_has_some() {
    let folder = tempfile::tempdir().unwrap();
    let (one, other) = Server::two(folder.path()).await;
    for number in 0..MAPS {
        let (writer, reader) = if number % 2 == 0 { (&one, &other) } else { (&other, &one) };
        settled_put(writer, &path(number), &json!({})).await;
        let written = settled_put(reader, &format!("{}/keyframes/kf-1", path(number)), &shot(1)).await;
        assert_eq!(written["map_version"], 2);
        // What one server acknowledged, the other tells at once.
        let read = settled(writer, Method::GET, &format!("{}/keyframes/kf-1", path(number)), None).await;
        assert_eq!(read.status, 200, "{read:#?}");
        assert_eq!(read.body["map_version"], 2);
        let asked = json!({"keyframe": "kf-1"});
        let queries = format!("{}/loop-queries", path(number));
        let answers = [
            settled(&one, Method::POST, &queries, Some(&asked)).await.expect(200),
            settled(&other, Method::POST, &queries, Some(&asked)).await.expect(200),
        ];
        assert_eq!(answers[0], answers[1]);
    }
    let (from_one, from_other) = (owners(&one).await, owners(&other).await);
    assert_eq!(from_one, from_other, "both name the same owners");
    for server in [&one, &other] {
        let owned = from_one.iter().filter(|owner| **owner == server.url("")).count();
        assert!((1..MAPS).contains(&owned), "{owned} of {MAPS}: {from_one:?}");
    }
    let page = Answer::text(one.request(Method::GET, "/metrics")).await;
    assert!(!page.contains("revisit_forwarded_total{outcome=\"answered\"} 0\n"), "{page}");

    // An error is the same whichever server is asked.
    let (of_one, of_other) = (
        settled(&one, Method::PUT, &format!("{}/keyframes/kf-9", path(0)), Some(&json!({}))).await,
        settled(&other, Method::PUT, &format!("{}/keyframes/kf-9", path(0)), Some(&json!({}))).await,
    );
    for key in ["status", "code", "detail", "errors"] {
        assert_eq!(of_one.body[key], of_other.body[key], "{key}: {of_one:#?}, {of_other:#?}");
    }
    assert!(of_one.body["errors"].as_array().is_some_and(|errors| !errors.is_empty()), "{of_one:#?}");

    // What shows a secret that is not this server's is not sent on: it could come back.
    let elsewhere = (0..MAPS).find(|number| from_one[*number] != one.url("")).expect("one");
    let forged = one.request(Method::GET, &path(elsewhere)).header("x-revisit-forwarded", "guessed");
    assert_eq!(Answer::of(forged).await.status, 503);

    // One goes as on SIGTERM: its maps are the other's at once, with all that was acknowledged.
    let begun = Instant::now();
    other.stop().await;
    for number in 0..MAPS {
        let written = settled_put(&one, &format!("{}/keyframes/kf-2", path(number)), &shot(2)).await;
        assert_eq!(written["map_version"], 3, "{written:#}");
    }
    println!("{:.1} s until every map of a server that stopped took a write", begun.elapsed().as_secs_f64());
    one.stop().await;
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs REVISIT_TEST_POSTGRES"]
async fn a_server_that_joins_takes_maps_over_while_robots_write() {
    let folder = tempfile::tempdir().unwrap();
    let one = Server::among_others(folder.path()).await;
    for number in 0..MAPS {
        settled_put(&one, &path(number), &json!({})).await;
    }
    let mut streams = Vec::new();
    for number in 0..MAPS {
        let events = one.request(Method::GET, &format!("{}/events", path(number)));
        streams.push(events.send().await.expect("an answer"));
    }
    let joined = Server::among_others(folder.path()).await;
    let begun = Instant::now();
    let mut round = 0;
    let mut acknowledged = [1_u64; MAPS];
    while joined.figure("revisit_leases").await == 0 || one.figure("revisit_leases").await == MAPS as u64 {
        assert!(begun.elapsed() < OWNERS_SETTLE, "no map was taken over");
        round += 1;
        for (number, version) in acknowledged.iter_mut().enumerate() {
            let keyframe = format!("{}/keyframes/kf-{round}", path(number));
            let written = settled_put(&one, &keyframe, &shot(round)).await;
            *version += 1;
            assert_eq!(written["map_version"], *version, "each version is of one write: {written:#}");
        }
    }
    println!(
        "{:.1} s and {round} writes a map until a server that joined had maps",
        begun.elapsed().as_secs_f64()
    );
    for (number, version) in acknowledged.iter().enumerate() {
        for server in [&one, &joined] {
            let map = settled(server, Method::GET, &path(number), None).await.expect(200);
            assert_eq!((&map["keyframes"], &map["map_version"]), (&json!(round), &json!(version)));
        }
    }
    // Who listens at the server that had a map hears that it is to ask anew.
    for (owner, mut stream) in owners(&one).await.into_iter().zip(streams) {
        if owner == joined.url("") {
            let ends = async { while stream.chunk().await.expect("a stream").is_some() {} };
            tokio::time::timeout(OWNERS_SETTLE, ends).await.expect("the stream of a map that moved ends");
        }
    }
    joined.stop().await;
    one.stop().await;
}

/// Waits until an erasure is done, whichever server has its map.
async fn erased(server: &Server, id: &str) {
    let begun = Instant::now();
    loop {
        let erasure =
            settled(server, Method::GET, &format!("{}/erase/{id}", path(0)), None).await.expect(200);
        if erasure["state"] == "done" {
            return;
        }
        assert!(begun.elapsed() < OWNERS_SETTLE, "{erasure:#}");
        tokio::time::sleep(Duration::from_millis(100)).await;
    }
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs REVISIT_TEST_POSTGRES"]
async fn erasures_follow_one_another_and_go_on_where_their_map_goes() {
    const KEYFRAMES: usize = 60;
    let folder = tempfile::tempdir().unwrap();
    let (one, two) = Server::two(folder.path()).await;
    settled_put(&one, &path(0), &json!({})).await;
    let ids: Vec<String> = (0..KEYFRAMES).map(|number| format!("kf-{number}")).collect();
    for (number, id) in ids.iter().enumerate() {
        settled_put(&one, &format!("{}/keyframes/{id}", path(0)), &shot(number)).await;
    }
    let erase = format!("{}/erase", path(0));
    for id in ["e-1", "e-2"] {
        let one_keyframe = json!({"keyframes": [format!("kf-{id}").replace("e-", "")]});
        let asked = settled(&one, Method::POST, &erase, Some(&one_keyframe)).await;
        assert_eq!((asked.status.as_u16(), &asked.body["id"]), (202, &json!(id)), "{asked:#?}");
        erased(&two, id).await;
        // The lease of a map that is not in memory is given back with a renewal.
        tokio::time::sleep(Duration::from_secs(4)).await;
    }
    let owner = settled(&one, Method::GET, &path(0), None).await.header("x-revisit-owner").to_owned();
    let (owner, other) = if owner == one.url("") { (one, two) } else { (two, one) };
    let asked = settled(&other, Method::POST, &erase, Some(&json!({"keyframes": ids[10..]}))).await;
    assert_eq!(asked.status, 202, "{asked:#?}");
    owner.stop().await;
    erased(&other, "e-3").await;
    let map = settled(&other, Method::GET, &path(0), None).await.expect(200);
    assert_eq!(map["keyframes"], json!(8), "{map:#}");
    let erasure = settled(&other, Method::GET, &format!("{erase}/e-3"), None).await.expect(200);
    assert_eq!(erasure["keyframes"], json!(KEYFRAMES - 10), "counted here and there: {erasure:#}");
    other.stop().await;
}

/// Lists a server that does not listen at its address among those of a database.
async fn silent_server(db: &mut PgConnection, lasts_s: f64) -> TcpSocket {
    let socket = TcpSocket::new_v4().expect("a socket");
    socket.bind(SocketAddr::from(([127, 0, 0, 1], 0))).expect("a port");
    let address = format!("http://{}", socket.local_addr().expect("an address"));
    let insert = "insert into nodes (node, address, secret, schema, expires)
        values ('silent', $1, 'secret', 1000, clock_timestamp() + make_interval(secs => $2))";
    sqlx::query(insert).bind(address).bind(lasts_s).execute(db).await.expect("a row");
    socket
}

/// Gives a map to a server that does not answer, as if it had been killed just after it extended its leases.
async fn left_by_a_silent_server(directory: &Path, map: &str) -> TcpSocket {
    let mut db = PgConnection::connect(&postgres_of(directory).await).await.expect("the database");
    let lasts_s = 8.0;
    let socket = silent_server(&mut db, lasts_s).await;
    let update =
        "update map_owners set owner = 'silent', epoch = epoch + 1, expires = clock_timestamp() + make_interval(secs => $2)
        where map_key = (select map_key from maps where id = $1)";
    let given = sqlx::query(update).bind(map).bind(lasts_s).execute(&mut db).await.expect("a row");
    assert_eq!(given.rows_affected(), 1);
    socket
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs REVISIT_TEST_POSTGRES"]
async fn a_server_that_left_is_not_asked_for_maps_that_nobody_has() {
    let folder = tempfile::tempdir().unwrap();
    let server = Server::among_others(folder.path()).await;
    let mut db = PgConnection::connect(&postgres_of(folder.path()).await).await.expect("the database");
    let _silent = silent_server(&mut db, 600.0).await;
    let begun = Instant::now();
    while server.figure("revisit_nodes").await < 2 {
        assert!(begun.elapsed() < OWNERS_SETTLE, "the other server is not heard of");
        tokio::time::sleep(Duration::from_millis(50)).await;
    }
    let mut refused = Vec::new();
    for number in 0..MAPS {
        let answer = server.put(&path(number), &json!({})).await;
        if answer.status == StatusCode::SERVICE_UNAVAILABLE {
            refused.push(number);
        }
    }
    assert!((1..MAPS).contains(&refused.len()), "maps that the other one should have: {refused:?}");
    sqlx::query("delete from nodes where node = 'silent'").execute(&mut db).await.expect("no row");
    // A list of servers that was read a moment ago is believed.
    tokio::time::sleep(Duration::from_millis(400)).await;
    for number in refused {
        let answer = server.put(&path(number), &json!({})).await;
        assert_eq!(answer.status, StatusCode::CREATED, "{answer:#?}");
    }
    server.stop().await;
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs REVISIT_TEST_POSTGRES"]
async fn a_map_of_a_server_that_fell_silent_is_loaded_while_its_lease_runs_out() {
    let folder = tempfile::tempdir().unwrap();
    let server = Server::among_others(folder.path()).await;
    server.put("/v1/maps/m", &json!({})).await;
    for number in 0..12 {
        server.put(&format!("/v1/maps/m/keyframes/kf-{number}"), &shot(number)).await;
    }
    let reads = ["/v1/maps/m", "/v1/maps/m/keyframes/kf-7", "/v1/maps/m/export"];
    let mut before = Vec::new();
    for path in reads {
        before.push(server.get(path).await.bytes);
    }
    server.stop().await;
    let server = Server::among_others(folder.path()).await;
    let _silent = left_by_a_silent_server(folder.path(), "m").await;
    let refused = server.get("/v1/maps/m").await;
    assert_eq!(refused.status, StatusCode::SERVICE_UNAVAILABLE, "{refused:#?}");
    let begun = Instant::now();
    while server.figure("revisit_followed_maps").await == 0 {
        assert!(begun.elapsed() < OWNERS_SETTLE, "the map is not loaded ahead");
        tokio::time::sleep(Duration::from_millis(50)).await;
    }
    // No lease is taken while the other one lasts.
    assert_eq!(server.figure("revisit_leases").await, 0);
    for (path, before) in reads.into_iter().zip(before) {
        let read = settled(&server, Method::GET, path, None).await;
        assert_eq!((read.status, &read.bytes), (StatusCode::OK, &before), "{path}");
    }
    let figures = ["revisit_map_promotions", "revisit_map_loads", "revisit_followed_maps", "revisit_leases"];
    let mut told = Vec::new();
    for name in figures {
        told.push(server.figure(name).await);
    }
    assert_eq!(told, [1, 1, 0, 1], "{figures:?}");
    let written = settled_put(&server, "/v1/maps/m/keyframes/kf-12", &shot(12)).await;
    assert_eq!(written["map_version"], 14);
    server.stop().await;
}
