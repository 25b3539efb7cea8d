//! `revisit copy`: everything in a database goes into another one, of either engine.

use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::Duration;

use reqwest::Method;
use serde_json::{Value, json};

use crate::support::{Answer, Server, keyframe, postgres_of};

fn copy(from: &str, to: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_revisit"));
    command.args(["copy", "--from", from, "--to", to]).env_remove("REVISIT_DATABASE");
    command
}

fn copied(from: &str, to: &str) -> Output {
    copy(from, to).output().expect("it runs")
}

fn file(folder: &Path, name: &str) -> String {
    format!("sqlite://{}", folder.join(name).display())
}

fn shot(number: usize) -> Value {
    let mut body = keyframe();
    body["stamp"] = json!({"sec": number, "nanosec": 0});
    body["bow"] = json!({"words": [number % 7, 10 + number % 5], "weights": [1, 2]});
    body["observes"] = json!([number, number + 1, number + 2]);
    body["map_points"] = json!({"ids": [number], "positions": [[1.0, 2.0, number]]});
    body["detections"] = json!([{"class": "door_number", "confidence": 0.9, "box": [1, 2, 30, 40],
        "position": [0.0, 0.0, 2.0], "text": format!("{}", 900 + number % 9)}]);
    body
}

/// Fills two maps with what a fleet leaves: keyframes, a loop, a query's record, a correction, a release, a deleted map.
async fn filled(server: &Server) {
    for map in ["annex", "hotel", "gone"] {
        server
            .put(&format!("/v1/maps/{map}"), &json!({"description": map, "settings": {"keep_history": true}}))
            .await
            .expect(201);
        for number in 0..40 {
            server.put(&format!("/v1/maps/{map}/keyframes/kf-{number}"), &shot(number)).await.expect(201);
        }
    }
    server
        .post("/v1/maps/hotel/loops", &json!({"id": "l-1", "keyframe": "kf-30", "candidate": "kf-3"}))
        .await
        .expect(201);
    let poses = json!({"session": "default", "keyframes": {"ids": ["kf-2"], "poses": [keyframe()["pose"]]}});
    server.post("/v1/maps/hotel/poses", &poses).await.expect(200);
    server.put("/v1/maps/hotel/releases/spring", &json!({})).await.expect(201);
    server.delete("/v1/maps/hotel/keyframes/kf-9").await.expect(200);
    server.delete("/v1/maps/gone").await.expect(204);
}

/// The answers of the maps about themselves; the list of maps tells which there are.
async fn told(server: &Server) -> Vec<(String, bytes::Bytes)> {
    let query = json!({"keyframe": "kf-30"});
    let mut told = Vec::new();
    for map in ["annex", "hotel"] {
        let asked = server.post(&format!("/v1/maps/{map}/loop-queries"), &query).await;
        assert_eq!(asked.status, 200, "{asked:#?}");
        told.push((format!("a query of {map}"), asked.bytes));
        for what in [
            "",
            "/keyframes?limit=100",
            "/anchors?limit=100",
            "/loops",
            "/export",
            "/trajectory?session=default&format=tum",
        ] {
            let path = format!("/v1/maps/{map}{what}");
            let read = Answer::of(server.request(Method::GET, &path)).await;
            assert_eq!(read.status, 200, "{path}: {read:#?}");
            told.push((path, read.bytes));
        }
    }
    // Without the robots that asked it: this test is one of them.
    let mut releases = server.get("/v1/maps/hotel/releases").await.expect(200);
    releases["items"][0]["asked_by"] = json!([]);
    told.push(("releases".to_owned(), releases.to_string().into()));
    let released = json!({"keyframe": "kf-30", "release": "spring"});
    told.push(("a release".to_owned(), server.post("/v1/maps/hotel/loop-queries", &released).await.bytes));
    told.push(("maps".to_owned(), server.get("/v1/maps").await.bytes));
    told
}

#[track_caller]
fn same(told: &[(String, bytes::Bytes)], at_first: &[(String, bytes::Bytes)]) {
    assert_eq!(told.len(), at_first.len());
    for (now, before) in told.iter().zip(at_first) {
        assert_eq!(now, before);
    }
}

/// The events of a map as they are kept.
async fn first_event(server: &Server) -> Value {
    server.event("/v1/maps/hotel/events?since=0", |_| true).await
}

fn keys_of(database: &str) -> Vec<u8> {
    let program = env!("CARGO_BIN_EXE_revisit");
    let made =
        Command::new(program).args(["keys", "list", "--database", database]).output().expect("it runs");
    assert!(made.status.success(), "{made:?}");
    made.stdout
}

#[tokio::test(flavor = "multi_thread")]
async fn a_copy_that_is_killed_goes_on_and_ends_with_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let (from, to) = (file(folder.path(), "test.db"), file(folder.path(), "copy.db"));
    let server = Server::on(folder.path()).await;
    filled(&server).await;
    let (at_first, event) = (told(&server).await, first_event(&server).await);

    let refused = copied(&from, &to);
    assert!(!refused.status.success(), "a server has it open: {refused:?}");
    server.stop().await;

    // Each attempt is given a little longer, until one comes to its end.
    let mut lasted = Duration::from_millis(5);
    let mut kills = 0;
    loop {
        let mut child =
            copy(&from, &to).stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("it runs");
        tokio::time::sleep(lasted).await;
        if child.try_wait().expect("it is ours").is_some() {
            break;
        }
        child.kill().expect("it is ours");
        child.wait().expect("it ends");
        kills += 1;
        lasted += lasted / 2;
    }
    assert!(kills > 0, "nothing was broken off");
    let again = copied(&from, &to);
    let said = String::from_utf8(again.stdout.clone()).unwrap();
    assert!(again.status.success(), "{again:?}");
    assert_eq!(said.matches("was copied before").count(), 3, "two maps and a release: {said}");

    let folder_of_copy = tempfile::tempdir().unwrap();
    std::fs::rename(folder.path().join("copy.db"), folder_of_copy.path().join("test.db")).unwrap();
    let server = Server::on(folder_of_copy.path()).await;
    same(&told(&server).await, &at_first);
    assert_eq!(first_event(&server).await, event);
    // New maps of either are numbered alike from here on.
    server.put("/v1/maps/another", &json!({})).await.expect(201);
    server.stop().await;

    // What the source does not have is not mixed with what it has.
    let mixed = copied(&from, &file(folder_of_copy.path(), "test.db"));
    assert!(!mixed.status.success(), "{mixed:?}");
    assert!(String::from_utf8_lossy(&mixed.stderr).contains("map another"), "{mixed:?}");
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs REVISIT_TEST_POSTGRES"]
async fn a_database_goes_to_postgres_and_comes_back() {
    let folder = tempfile::tempdir().unwrap();
    let from = file(folder.path(), "test.db");
    let server = Server::on(folder.path()).await;
    filled(&server).await;
    let (at_first, event) = (told(&server).await, first_event(&server).await);
    server.stop().await;
    let postgres = postgres_of(folder.path()).await;
    let gone = copied(&from, &postgres);
    assert!(gone.status.success(), "{gone:?}");
    let server = Server::among_others(folder.path()).await;
    same(&told(&server).await, &at_first);
    assert_eq!(first_event(&server).await, event);
    let served = copied(&postgres, &file(folder.path(), "early.db"));
    assert!(
        String::from_utf8_lossy(&served.stderr).contains("the source is served by 1 server"),
        "{served:?}"
    );
    server.stop().await;

    // Once there is a key, servers ask for one: that it came along is told without them.
    let made = Command::new(env!("CARGO_BIN_EXE_revisit"))
        .args(["keys", "create", "--name", "me", "--actions", "read", "--database", &postgres])
        .output()
        .expect("it runs");
    assert!(made.status.success(), "{made:?}");
    let back = file(folder.path(), "back.db");
    let came = copied(&postgres, &back);
    assert!(came.status.success(), "{came:?}");
    assert_eq!(keys_of(&back), keys_of(&postgres));
    // What was revoked since is revoked in a copy that is taken up again, too.
    let revoked = Command::new(env!("CARGO_BIN_EXE_revisit"))
        .args(["keys", "revoke", "key-1", "--database", &postgres])
        .output()
        .expect("it runs");
    assert!(revoked.status.success(), "{revoked:?}");
    assert_ne!(keys_of(&back), keys_of(&postgres));
    let came = copied(&postgres, &back);
    assert!(came.status.success(), "{came:?}");
    assert_eq!(keys_of(&back), keys_of(&postgres));
    let checked = Command::new(env!("CARGO_BIN_EXE_revisit")).args(["check", "--database", &back]).output();
    assert!(checked.as_ref().is_ok_and(|checked| checked.status.success()), "{checked:?}");
}
