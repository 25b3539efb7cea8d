//! Damage: a row that holds what nobody wrote is an error that names it, and no backup of it is called verified.

use std::os::unix::fs::FileTypeExt as _;
use std::path::Path;

use serde_json::{Value, json};

use super::checks::{run_sql, sound_database};
use super::{checked, keyframe, names, revisit, sound, url};
use crate::crash::server::Server as Process;
use crate::support::Server;

/// A statement that damages map `tower`, a path that reads it, and what the answer says.
const DAMAGES: &[(&str, &str, &str)] = &[
    (
        "update keyframes set pose = zeroblob(56) where map_key = 1 and keyframe = 2",
        "/anchors",
        "the pose of keyframe day-1:2",
    ),
    ("update keyframes set pose = x'00' where map_key = 1 and keyframe = 2", "/anchors", "keyframe number 2"),
    (
        "update keyframes set session = 9 where map_key = 1 and keyframe = 2",
        "/anchors",
        "keyframe day-1:2 belongs to no session",
    ),
    (
        "update keyframes set observes = x'010401' where map_key = 1 and keyframe = 2",
        "/anchors",
        "not in order",
    ),
    ("update maps set next_anchor = 1 where id = 'tower'", "/anchors", "is given next"),
    (
        "update detections set class = 'lift' where map_key = 1 and keyframe = 0 and detection = 0",
        "/anchors",
        "of another class",
    ),
    ("delete from anchors where map_key = 1 and anchor = 0", "/anchors", "feeds an anchor that is not there"),
    ("delete from loops", "/anchors", "merged by loop loop-1"),
    // The fourth of a block, alone and infinitely far.
    (
        "update point_blocks set points = x'0800000000000000000000000000f07f00000000000000000000000000000000'
            where map_key = 1 and session = 0 and block = 0",
        "/anchors",
        "map point 3",
    ),
    (
        "update keyframe_features set keypoints = x'0011' where map_key = 1",
        "/keyframes/day-1:0",
        "the features",
    ),
    (
        "update keyframes set digest = x'00' where map_key = 1 and keyframe = 0",
        "/keyframes/day-1:0",
        "a digest",
    ),
    (
        "update detections set detection = 7 where map_key = 1 and keyframe = 1 and detection = 1",
        "/keyframes/day-1:1",
        "detection 1 is not there",
    ),
    ("update crops set bytes = x'00' where map_key = 1", "/anchors/a-0/crop", "the crop of detection 0"),
];

async fn two_maps(folder: &Path) {
    sound_database(folder).await;
    let server = Server::on(folder).await;
    server.put("/v1/maps/other", &json!({})).await.expect(201);
    server.put("/v1/maps/other/keyframes/kf-1", &keyframe("a", 1)).await.expect(201);
    server.stop().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_damaged_row_is_answered_with_a_problem_and_other_maps_are_not_affected() {
    let folder = tempfile::tempdir().unwrap();
    two_maps(folder.path()).await;
    let database = folder.path().join("test.db");
    let sound = std::fs::read(&database).unwrap();
    for (sql, path, expected) in DAMAGES {
        std::fs::write(&database, &sound).unwrap();
        run_sql(&database, sql).await;
        let server = Server::on(folder.path()).await;
        let problem = server.get(&format!("/v1/maps/tower{path}")).await;
        assert_eq!(problem.body["code"], "map_damaged", "{sql}: {problem:#?}");
        let detail = problem.expect(500)["detail"].as_str().unwrap().to_owned();
        assert!(detail.contains("map tower is damaged") && detail.contains(expected), "{sql}: {detail}");
        server.get("/v1/maps/other/keyframes/kf-1").await.expect(200);
        // And there is a way out of it.
        assert!(server.delete("/v1/maps/tower").await.status.is_success(), "{sql}");
        assert_eq!(server.get("/v1/maps/tower").await.status, 404, "{sql}");
        server.put("/v1/maps/tower", &json!({})).await.expect(201);
        server.stop().await;
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn a_copy_of_a_damaged_database_is_kept_and_not_called_verified() {
    let folder = tempfile::tempdir().unwrap();
    two_maps(folder.path()).await;
    let (database, backup) = (folder.path().join("test.db"), folder.path().join("tonight.db"));
    let (from, to) = (url(&database), backup.display().to_string());
    revisit(&["backup", "--database", &from, &to]).well();
    let before = std::fs::read(&backup).unwrap();
    run_sql(&database, DAMAGES[0].0).await;

    let ran = revisit(&["backup", "--force", "--database", &from, &to]);
    assert!(!ran.succeeded && !ran.out.contains("verified"), "{ran:?}");
    assert!(
        ran.err.contains("not verified") && ran.err.contains("map tower: the pose of keyframe day-1:2"),
        "{ran:?}"
    );
    assert!(before == std::fs::read(&backup).unwrap(), "the backup of the night before is replaced");
    let kept = folder.path().join("tonight.db.damaged");
    let (elsewhere, kept_name) = (folder.path().join("elsewhere.db"), kept.display().to_string());
    revisit(&["restore", "--database", &url(&elsewhere), &kept_name]).refused("cannot be restored");
    assert!(!elsewhere.exists());
    let told = revisit(&["restore", "--damaged", "--database", &url(&elsewhere), &kept_name]).well();
    assert!(told.contains("not verified") && told.contains("fault: map tower"), "{told}");
    let server = Process::start(&elsewhere);
    assert_eq!(server.api().get("/v1/maps/tower/anchors").await.status, 500);
    assert_eq!(server.api().get("/v1/maps/other/keyframes/kf-1").await.status, 200);
    drop(server);

    let backups = folder.path().join("backups");
    let server = Process::start_with(&database, &["--backups", &backups.display().to_string()]);
    for _ in 0..2 {
        let refused = server.api().post("/v1/backups", &json!({"id": "night"})).await;
        assert_eq!((refused.status, &refused.json()["code"]), (500, &json!("backup_not_verified")));
        assert!(refused.text().contains("map tower: the pose of keyframe"), "{}", refused.text());
    }
    assert_eq!(names(&backups).into_iter().collect::<Vec<_>>(), ["latest.damaged"]);
    assert_eq!(server.api().get("/v1/backups").await.json()["items"], json!([]));
}

#[tokio::test(flavor = "multi_thread")]
async fn only_regular_files_are_replaced() {
    let folder = tempfile::tempdir().unwrap();
    two_maps(folder.path()).await;
    let (database, backup) = (folder.path().join("test.db"), folder.path().join("backup.db"));
    let from = url(&database);
    revisit(&["backup", "--database", &from, &backup.display().to_string()]).well();
    let [socket, link, directory] = ["socket", "link", "directory"].map(|name| folder.path().join(name));
    let _listening = std::os::unix::net::UnixListener::bind(&socket).unwrap();
    std::os::unix::fs::symlink(folder.path().join("precious"), &link).unwrap();
    std::fs::create_dir(&directory).unwrap();
    for special in [&socket, &link, &directory] {
        let name = special.display().to_string();
        revisit(&["backup", "--force", "--database", &from, &name]).refused("is not a regular file");
    }
    for special in [&socket, &directory] {
        let target = url(special);
        revisit(&["restore", "--force", "--database", &target, &backup.display().to_string()])
            .refused("is not a regular file");
    }
    assert!(std::fs::symlink_metadata(&socket).unwrap().file_type().is_socket());
    assert!(std::fs::symlink_metadata(&link).unwrap().is_symlink() && directory.is_dir());
}

#[tokio::test(flavor = "multi_thread")]
async fn a_shortened_log_is_a_fault_as_long_as_its_index_tells() {
    let folder = tempfile::tempdir().unwrap();
    let database = folder.path().join("killed.db");
    let mut server = Process::start(&database);
    assert_eq!(server.api().put("/v1/maps/tower", &json!({})).await.status, 201);
    assert_eq!(server.api().put("/v1/maps/tower/keyframes/kf-1", &keyframe("a", 1)).await.status, 201);
    server.kill();
    let [log, index] = ["killed.db-wal", "killed.db-shm"].map(|name| folder.path().join(name));
    let whole = std::fs::read(&log).unwrap();
    let mut flipped = whole.clone();
    let middle = flipped.len() / 2;
    flipped[middle] ^= 1;
    let damaged =
        [whole[..whole.len() - 1].to_vec(), whole[..middle].to_vec(), whole[..32].to_vec(), flipped];
    for bytes in damaged {
        std::fs::write(&log, &bytes).unwrap();
        // Looking changes nothing, so it may be asked again.
        for _ in 0..2 {
            let faults: Vec<String> = checked(&database).await.all_faults().collect();
            assert!(
                faults.iter().any(|fault| fault.contains("committed frames")),
                "{}: {faults:?}",
                bytes.len()
            );
        }
        let taken = revisit(&[
            "backup",
            "--force",
            "--database",
            &url(&database),
            &folder.path().join("b.db").display().to_string(),
        ]);
        taken.refused("committed frames");
    }
    std::fs::remove_file(&log).unwrap();
    let faults: Vec<String> = checked(&database).await.all_faults().collect();
    assert!(faults.iter().any(|fault| fault.contains("0 of ")), "{faults:?}");

    // Whole again, it is sound; without the index nothing can be told.
    std::fs::write(&log, &whole).unwrap();
    let found = checked(&database).await;
    assert_eq!((found.all_faults().count(), found.notes.len()), (0, 0), "{found:?}");
    std::fs::remove_file(&index).unwrap();
    std::fs::write(&log, &whole[..whole.len() - 1]).unwrap();
    let found = checked(&database).await;
    assert!(found.notes.iter().any(|note| note.contains("ends within a frame")), "{found:?}");
}

#[tokio::test(flavor = "multi_thread")]
async fn points_in_any_order_are_stored_in_one() {
    let folder = tempfile::tempdir().unwrap();
    let server = Server::on(folder.path()).await;
    server.put("/v1/maps/tower", &json!({})).await.expect(201);
    let mut body = keyframe("a", 1);
    body["map_points"] = json!({"ids": [9_223_372_036_854_775_807_u64, 1, 2], "positions": [[9, -0.0, 0], [1, 0, 0], [2, 0, 0]]});
    body["observes"] = json!([2, 1, 2]);
    server.put("/v1/maps/tower/keyframes/kf", &body).await.expect(201);
    let again = server.put("/v1/maps/tower/keyframes/kf", &body).await;
    assert_eq!(again.header("idempotent-replayed"), "true");
    let stored = server.get("/v1/maps/tower/keyframes/kf").await.expect(200);
    assert_eq!(stored["map_points"]["ids"], json!([1, 2, 9_223_372_036_854_775_807_u64]), "{stored}");
    // A zero has one form: a restart would take the sign of the other.
    assert_eq!(stored["map_points"]["positions"][2].to_string(), "[9.0,0.0,0.0]");
    server.stop().await;
    sound(&folder.path().join("test.db")).await;
    let server = Server::on(folder.path()).await;
    assert_eq!(server.get("/v1/maps/tower/keyframes/kf").await.expect(200), stored);
    let _: Value = server.put("/v1/maps/tower/keyframes/kf", &body).await.expect(200);
}
