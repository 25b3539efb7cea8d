//! Backups that clients ask for: named by an id, one at a time, the oldest make room.

use std::path::Path;

use reqwest::Method;
use serde_json::{Value, json};

use super::{keyframe, names, sound};
use crate::crash::server::{Answer, Api, Server};

fn serve(folder: &Path, kept: &str) -> Server {
    let backups = folder.join("backups").display().to_string();
    Server::start_with(&folder.join("revisit.db"), &["--backups", &backups, "--backups-kept", kept])
}

async fn take(api: &Api, id: &str) -> Answer {
    api.post("/v1/backups", &json!({"id": id})).await
}

fn ids(list: &Value) -> Vec<&str> {
    list["items"].as_array().unwrap().iter().map(|item| item["id"].as_str().unwrap()).collect()
}

#[tokio::test(flavor = "multi_thread")]
async fn a_backup_is_named_by_its_id_and_a_retry_finds_it() {
    let folder = tempfile::tempdir().unwrap();
    let server = serve(folder.path(), "7");
    let api = server.api();
    assert_eq!(api.put("/v1/maps/tower", &json!({})).await.status, 201);
    assert_eq!(api.put("/v1/maps/tower/keyframes/kf-1", &keyframe("a", 1)).await.status, 201);
    let taken = take(api, "before").await;
    assert_eq!((taken.status, taken.replayed), (201, false), "{}", taken.text());
    let report = taken.json();
    assert_eq!(
        (&report["maps"], &report["keyframes"], &report["removed"]),
        (&json!(1), &json!(1), &json!([]))
    );
    let file = folder.path().join("backups/before.db");
    assert_eq!(report["bytes"], std::fs::metadata(&file).unwrap().len());
    let sha256 = std::process::Command::new("sha256sum").arg(&file).output().unwrap().stdout;
    assert!(String::from_utf8(sha256).unwrap().starts_with(report["sha256"].as_str().unwrap()));
    sound(&file).await;

    // Another keyframe has come, but a retry asks for the same backup.
    assert_eq!(api.put("/v1/maps/tower/keyframes/kf-2", &keyframe("a", 2)).await.status, 201);
    let again = take(api, "before").await;
    assert_eq!((again.status, again.replayed), (200, true));
    assert_eq!(again.json()["sha256"], report["sha256"]);
    let unnamed = api.post("/v1/backups", &json!({})).await;
    assert_eq!((unnamed.status, &unnamed.json()["keyframes"]), (201, &json!(2)));
    let list = api.get("/v1/backups?limit=1").await.json();
    assert_eq!(ids(&list), [unnamed.json()["id"].as_str().unwrap()], "the newest first");
    let rest = api.get(&format!("/v1/backups?cursor={}", list["next_cursor"].as_str().unwrap())).await.json();
    assert_eq!((ids(&rest), &rest["next_cursor"]), (vec!["before"], &Value::Null));

    assert!(!api.get("/metrics").await.text().contains("revisit_newest_backup_seconds 0\n"));
    for status in [204, 404] {
        let deleted = Answer::unless_gone(api.request(Method::DELETE, "/v1/backups/before")).await;
        assert_eq!(deleted.expect("an answer").status, status);
    }
    assert!(!file.exists() && !file.with_extension("json").exists());
    assert_eq!(ids(&api.get("/v1/backups").await.json()), [unnamed.json()["id"].as_str().unwrap()]);
}

#[tokio::test(flavor = "multi_thread")]
async fn the_oldest_make_room_and_nothing_else_is_touched() {
    let folder = tempfile::tempdir().unwrap();
    let server = serve(folder.path(), "2");
    let backups = folder.path().join("backups");
    std::fs::write(backups.join("mine.db"), "precious").unwrap();
    for id in ["one", "two", "three"] {
        assert_eq!(take(server.api(), id).await.status, 201);
    }
    assert_eq!(ids(&server.api().get("/v1/backups").await.json()), ["three", "two"]);
    let taken = take(server.api(), "four").await.json();
    assert_eq!(taken["removed"], json!(["two"]));
    let expected = ["four.db", "four.json", "mine.db", "three.db", "three.json"];
    assert_eq!(names(&backups).into_iter().collect::<Vec<_>>(), expected);
    let foreign = take(server.api(), "mine").await;
    assert_eq!((foreign.status, &foreign.json()["code"]), (409, &json!("backup_exists")));
    assert_eq!(std::fs::read(backups.join("mine.db")).unwrap(), b"precious");
}

#[tokio::test(flavor = "multi_thread")]
async fn a_client_names_no_path_and_waits_for_its_turn() {
    let folder = tempfile::tempdir().unwrap();
    let server = serve(folder.path(), "1000");
    for id in ["../evil", "a/b", "", "/etc/passwd", "a\0b", ".", ".."] {
        assert_eq!(take(server.api(), id).await.status, 422, "{id:?}");
    }
    assert_eq!(server.api().post("/v1/backups", &json!({"path": "/tmp/evil.db"})).await.status, 422);
    let at_once = (0..8).map(|n| (server.api().clone(), format!("b{n}")));
    let tasks: Vec<_> = at_once.map(|(api, id)| tokio::spawn(async move { take(&api, &id).await })).collect();
    let mut taken = 0;
    for task in tasks {
        let answer = task.await.unwrap();
        match answer.status {
            201 => taken += 1,
            other => {
                assert_eq!(
                    (other, &answer.json()["code"]),
                    (503, &json!("unavailable")),
                    "{}",
                    answer.text()
                );
            }
        }
    }
    assert!(taken > 0);
}

#[tokio::test(flavor = "multi_thread")]
async fn without_a_folder_it_is_refused_and_says_why() {
    let server = crate::support::Server::start().await;
    let refused = server.post("/v1/backups", &json!({})).await;
    assert_eq!(refused.body["code"], "no_backup_folder");
    assert!(refused.expect(409)["detail"].as_str().unwrap().contains("--backups DIR"));
    assert_eq!(server.get("/v1/backups").await.expect(200)["items"], json!([]));
    assert_eq!(server.request(Method::GET, "/v1/backups?cursor=x").send().await.unwrap().status(), 200);
}
