//! Retention over HTTP: what a map's settings let go of, and what stays.

use std::path::Path;
use std::time::Duration;

use serde_json::{Value, json};
use sqlx::sqlite::SqliteConnectOptions;
use sqlx::{ConnectOptions as _, Executor as _};

use crate::exports::{keyframe, lived};
use crate::support::Server;

const MAP: &str = "/v1/maps/m";
const OFTEN: Duration = Duration::from_millis(20);

/// Makes all keyframes so many days older.
async fn age(folder: &Path, days: i64) {
    let file = SqliteConnectOptions::new().filename(folder.join("test.db"));
    let mut db = file.connect().await.unwrap();
    let update = format!("update keyframes set stored_sec = stored_sec - {}", days * 86_400);
    db.execute(sqlx::AssertSqlSafe(update)).await.unwrap();
}

async fn count(folder: &Path, of: &str) -> i64 {
    let file = SqliteConnectOptions::new().filename(folder.join("test.db")).read_only(true);
    let mut db = file.connect().await.unwrap();
    sqlx::query_scalar(sqlx::AssertSqlSafe(format!("select count(*) from {of}")))
        .fetch_one(&mut db)
        .await
        .unwrap()
}

async fn becomes(folder: &Path, of: &str, wanted: i64) {
    while count(folder, of).await != wanted {
        tokio::time::sleep(OFTEN).await;
    }
}

async fn set(server: &Server, settings: Value) {
    server.patch(MAP, &json!({"settings": settings})).await.expect(200);
}

#[tokio::test(flavor = "multi_thread")]
async fn crops_and_old_descriptors_go_and_words_and_signs_stay() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let server = Server::with_retention_every(folder, OFTEN).await;
    lived(&server).await;
    let before = server.get(MAP).await.expect(200);
    let signs = server.get(&format!("{MAP}/anchors")).await.expect(200)["items"].clone();
    assert_eq!((count(folder, "crops").await, count(folder, "keyframe_features").await), (7, 7));

    let has_crop = async |server: &Server| {
        let read = server.get(&format!("{MAP}/keyframes/kf-0")).await.expect(200);
        [0, 1].map(|number| read["detections"][number]["has_crop"].clone())
    };
    assert_eq!(has_crop(&server).await, [json!(false), json!(true)]);
    set(&server, json!({"keep_crops": false})).await;
    becomes(folder, "crops", 0).await;
    assert_eq!(has_crop(&server).await, [json!(false), json!(false)]);
    server.stop().await;
    age(folder, 3).await;
    let server = Server::with_retention_every(folder, OFTEN).await;
    let old = server.get(&format!("{MAP}/keyframes/kf-0")).await.expect(200);
    server.put(&format!("{MAP}/keyframes/young"), &keyframe("robot-3", 500, 0.4, "901")).await.expect(201);
    set(&server, json!({"keep_descriptors_days": 2})).await;
    becomes(folder, "keyframe_features", 1).await;
    becomes(folder, "keyframes where global_descriptor is not null", 1).await;

    let after = server.get(MAP).await.expect(200);
    assert_eq!(after["keyframes"], 8);
    assert!(after["bytes"].as_u64() < before["bytes"].as_u64(), "{after:#}");
    let now = server.get(&format!("{MAP}/keyframes/kf-0")).await.expect(200);
    assert!(now.get("features").is_none() && now.get("global_descriptor").is_none(), "{now:#}");
    assert_eq!(now["bow"], old["bow"]);
    // A keyframe without features is a candidate by its words and signs, and geometry is skipped.
    let asked = server.post(&format!("{MAP}/loop-queries"), &json!({"keyframe": "young"})).await.expect(200);
    let candidates = asked["candidates"].as_array().unwrap();
    assert!(
        !candidates.is_empty() && candidates.iter().all(|of| of["geometry"]["status"] == "skipped"),
        "{asked:#}"
    );
    let texts = |signs: &Value| -> Vec<Value> {
        signs.as_array().unwrap().iter().map(|of| of["description"].clone()).collect()
    };
    let now = server.get(&format!("{MAP}/anchors")).await.expect(200)["items"].clone();
    assert_eq!(texts(&now)[..texts(&signs).len()], texts(&signs)[..]);
    // A retry of what was sent is still known, and brings nothing back.
    let again = server.put(&format!("{MAP}/keyframes/kf-0"), &keyframe("robot-1", 1, 0.0, "901")).await;
    assert_eq!(again.header("idempotent-replayed"), "true");
    assert_eq!(count(folder, "keyframe_features").await, 1);

    server.stop().await;
    let check = tokio::task::spawn_blocking({
        let database = format!("sqlite://{}", folder.join("test.db").display());
        move || {
            std::process::Command::new(env!("CARGO_BIN_EXE_revisit"))
                .args(["check", "--database", &database])
                .output()
        }
    });
    let check = check.await.unwrap().unwrap();
    assert!(check.status.success(), "{}", String::from_utf8_lossy(&check.stdout));
}

#[tokio::test(flavor = "multi_thread")]
async fn old_keyframes_are_thinned_and_no_place_is_forgotten() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let server = Server::with_retention_every(folder, OFTEN).await;
    server.put(MAP, &json!({"settings": {"keep_keyframes_days": 2}})).await.expect(201);
    // Four robots see room 901 alike, and one of them 905.
    for (number, (x, plate)) in
        [(0.0, "901"), (0.0, "901"), (0.0, "901"), (0.0, "901"), (50.0, "905")].iter().enumerate()
    {
        let mut body = keyframe("robot-1", number as u32, *x, plate);
        body["detections"].as_array_mut().unwrap().truncate(1);
        body["observes"] = json!([]);
        server.put(&format!("{MAP}/keyframes/kf-{number}"), &body).await.expect(201);
    }
    let signs = server.get(&format!("{MAP}/anchors")).await.expect(200)["items"].as_array().unwrap().len();
    server.stop().await;
    age(folder, 3).await;
    let server = Server::with_retention_every(folder, OFTEN).await;
    becomes(folder, "keyframes", 2).await;
    let kept = server.get(&format!("{MAP}/keyframes")).await.expect(200);
    let ids: Vec<&Value> = kept["items"].as_array().unwrap().iter().map(|of| &of["id"]).collect();
    assert_eq!(ids, ["kf-3", "kf-4"]);
    assert_eq!(
        server.get(&format!("{MAP}/anchors")).await.expect(200)["items"].as_array().unwrap().len(),
        signs
    );
    let removed = |event: &Value| event["event"] == "keyframe_removed" && event["keyframe"] == "kf-0";
    server.event(&format!("{MAP}/events?since=0"), removed).await;
}
