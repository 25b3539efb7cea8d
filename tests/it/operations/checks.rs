//! Check: whatever is damaged is found, what is sound is called so, and nothing is written.

use std::path::{Path, PathBuf};

use revisit::integrity::backup::Copy;
use revisit::integrity::restore::{Allowed, restore};
use revisit::store::files::paths::DatabaseFiles;
use serde_json::{Value, json};
use sqlx::sqlite::{SqliteConnectOptions, SqliteJournalMode};
use sqlx::{AssertSqlSafe, ConnectOptions as _, Connection as _, Executor as _};

use super::{checked, keyframe, names, revisit, sound, url};
use crate::support::Server;

const PAGE_BYTES: usize = 16384;

/// A small map with everything in it, on a server that has stopped.
pub(super) async fn sound_database(folder: &Path) -> PathBuf {
    let server = Server::on(folder).await;
    server
        .put("/v1/maps/tower", &json!({"settings": {"covisibility_min_shared_points": 12}}))
        .await
        .expect(201);
    for session in ["day-1", "day-2"] {
        for number in 0..4 {
            let path = format!("/v1/maps/tower/keyframes/{session}:{number}?query=loop");
            server.put(&path, &keyframe(session, number)).await.expect(201);
        }
    }
    let closed = json!({"id": "loop-1", "keyframe": "day-2:1", "candidate": "day-1:1"});
    let merged = server.post("/v1/maps/tower/loops", &closed).await.expect(201);
    assert_ne!(merged["merged"], json!([]), "the loop must merge something");
    server.delete("/v1/maps/tower/keyframes/day-1:3").await;
    server.stop().await;
    folder.join("test.db")
}

pub(super) async fn run_sql(database: &Path, sql: &str) {
    let options = SqliteConnectOptions::new().filename(database).foreign_keys(false);
    let mut db = options.journal_mode(SqliteJournalMode::Delete).connect().await.unwrap();
    let done = db.execute(AssertSqlSafe(sql)).await.unwrap();
    assert!(done.rows_affected() > 0, "{sql} changed nothing");
    db.close().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn a_sound_database_is_called_so_and_not_touched() {
    let folder = tempfile::tempdir().unwrap();
    let database = sound_database(folder.path()).await;
    let before = (names(folder.path()), std::fs::read(&database).unwrap());
    assert!(!before.0.contains("test.db-wal"), "the log is in the database once the server has stopped");
    let told = revisit(&["check", "--database", &url(&database)]).well();
    assert!(told.starts_with("map tower: sound; version ") && told.ends_with("sound\n"), "{told}");
    assert!(told.contains("7 keyframes") && told.contains("1 loop,"), "{told}");
    let told: Value =
        serde_json::from_str(&revisit(&["check", "--json", database.to_str().unwrap()]).well()).unwrap();
    assert_eq!((&told["sound"], &told["maps"][0]["keyframes"]), (&json!(true), &json!(7)), "{told}");
    let after = (names(folder.path()), std::fs::read(&database).unwrap());
    assert_eq!(before.0, after.0);
    assert!(before.1 == after.1, "the file has changed");
}

#[tokio::test(flavor = "multi_thread")]
async fn a_log_that_a_kill_has_left_is_read_and_not_touched() {
    let folder = tempfile::tempdir().unwrap();
    let database = folder.path().join("killed.db");
    let mut server = crate::crash::server::Server::start(&database);
    assert_eq!(server.api().put("/v1/maps/tower", &json!({})).await.status, 201);
    assert_eq!(server.api().put("/v1/maps/tower/keyframes/kf-1", &keyframe("a", 1)).await.status, 201);
    // Beside the running server, too.
    assert_eq!(checked(&database).await.holds.unwrap().keyframes, 1);
    server.kill();
    let files = ["killed.db", "killed.db-wal"].map(|name| folder.path().join(name));
    let before = files.each_ref().map(|file| std::fs::read(file).unwrap());
    let found = sound(&database).await;
    assert_eq!(found.maps[0].keyframes, 1);
    assert!(before == files.each_ref().map(|file| std::fs::read(file).unwrap()));
}

#[tokio::test(flavor = "multi_thread")]
async fn every_damage_is_found() {
    let folder = tempfile::tempdir().unwrap();
    let sound = sound_database(folder.path()).await;
    // What is done, and what must be said of it.
    let damages = [
        ("delete from anchors where anchor = 0", "rows of detections refer to rows of anchors"),
        ("delete from keyframes where id = 'day-1:0'", "refer to rows of keyframes"),
        ("delete from sessions where id = 'day-2'", "refer to rows of sessions"),
        ("delete from maps", "refer to rows of maps"),
        ("delete from events where seq = 2", "event 3 follows upon 1"),
        ("delete from events where seq = (select max(seq) from events)", "is given next"),
        (
            "delete from detections where detection = 0 and keyframe = 1",
            "detection 0 of keyframe number 1 is not there",
        ),
        ("delete from loops", "merged by loop loop-1"),
        ("update maps set next_keyframe = 3", "keyframe 7 is there, and 3 is given next"),
        ("update maps set keyframes = keyframes + 1", "lists of maps show 8 keyframes, and it holds 7"),
        ("update maps set digest = x'00'", "a digest of another length"),
        ("update maps set next_anchor = 1", "is there, and 1 is given next"),
        (
            "update keyframes set pose = zeroblob(56) where keyframe = 2",
            "the pose of keyframe day-1:2 is none",
        ),
        ("update keyframes set pose = substr(pose, 1, 50) where keyframe = 2", "a packed list"),
        ("update keyframes set bow_weights = zeroblob(12) where keyframe = 0", "no column of integers"),
        ("update keyframes set digest = x'00' where keyframe = 0", "the digest of keyframe day-1:0"),
        ("update keyframes set id = 'a b' where keyframe = 0", "tower"),
        (
            "update keyframe_features set descriptors = substr(descriptors, 2)",
            "the features of keyframe day-1:0",
        ),
        ("update keyframe_features set keypoints = x'0011'", "the features of keyframe"),
        ("update point_blocks set points = substr(points, 2)", "block 0 of map points"),
        (
            "update detections set outcome = 'whatever' where anchor is null or detection = 1",
            "outcome whatever",
        ),
        (
            "update detections set class = 'lift' where keyframe = 0 and detection = 0",
            "of another class than its anchor",
        ),
        ("update crops set bytes = x'00' where keyframe = 0", "is no such image"),
        ("update loop_queries set body = substr(body, 1, 20)", "is damaged"),
        ("update events set kind = 'nothing' where seq = 1", "column \"kind\": \"nothing\" is none"),
        (
            "update maps set settings = replace(settings, ':12', ':\"many\"')",
            "covisibility_min_shared_points",
        ),
        ("drop table point_blocks", "no such table"),
        ("drop table _sqlx_migrations", "this version of revisit cannot read the database"),
    ];
    for (sql, expected) in damages {
        let damaged = folder.path().join("damaged.db");
        std::fs::copy(&sound, &damaged).unwrap();
        if sql.starts_with("drop") {
            let sql = format!("create table t (a integer); insert into t values (1); {sql}");
            run_sql(&damaged, &sql).await;
        } else {
            run_sql(&damaged, sql).await;
        }
        let faults: Vec<String> = checked(&damaged).await.all_faults().collect();
        assert!(faults.iter().any(|fault| fault.contains(expected)), "{sql}: {faults:#?}");
        // No backup of it is called verified, and none is restored.
        let files = DatabaseFiles::of_path(&damaged);
        let taken = Copy::of(&files, folder.path()).await;
        assert!(taken.is_err() || !taken.unwrap().faults().is_empty(), "{sql}: a backup is verified");
        let target = DatabaseFiles::of_path(&folder.path().join("target.db"));
        let restored = restore(&files, &target, Allowed::default()).await;
        assert!(restored.is_err() && !target.exist(), "{sql}: it is restored");
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn a_torn_page_a_short_file_and_a_foreign_file_are_found() {
    let folder = tempfile::tempdir().unwrap();
    let sound = sound_database(folder.path()).await;
    let bytes = std::fs::read(&sound).unwrap();
    let damaged = folder.path().join("damaged.db");
    let pages = bytes.len() / PAGE_BYTES;
    assert!(pages > 20);
    for page in 0..pages {
        let mut torn = bytes.clone();
        torn[page * PAGE_BYTES..][..16].iter_mut().for_each(|byte| *byte = !*byte);
        std::fs::write(&damaged, torn).unwrap();
        assert!(checked(&damaged).await.all_faults().next().is_some(), "page {page} of {pages}");
    }
    for length in [0, 1, 100, bytes.len() / 2, bytes.len() - PAGE_BYTES, bytes.len() - 1] {
        std::fs::write(&damaged, &bytes[..length]).unwrap();
        let ran = revisit(&["check", "--database", &url(&damaged)]);
        assert!(!ran.succeeded && ran.out.contains("fault: "), "{length}: {ran:?}");
    }
    std::fs::write(&damaged, "a text").unwrap();
    revisit(&["check", "--database", &url(&damaged)]).refused("1 fault");
    revisit(&["check", "--database", &url(&folder.path().join("nothing.db"))])
        .refused("there is no such file");
    assert!(!names(folder.path()).contains("nothing.db"), "a check makes no files");
}
