//! Backups: taken beside a running server, verified, and restored without a loss.

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use revisit::domain::counted::counted;
use serde_json::json;

use super::{Places, checked, keyframe, names, revisit, sound, url};
use crate::crash::server::Server;

async fn put(server: &Server, number: u64) {
    let path = format!("/v1/maps/tower/keyframes/kf-{number}");
    let answer = server.api().put(&path, &keyframe("a", number)).await;
    assert_eq!(answer.status, 201, "{}", answer.text());
}

async fn server_with_a_map(database: &Path) -> Server {
    let server = Server::start(database);
    assert_eq!(server.api().put("/v1/maps/tower", &json!({})).await.status, 201);
    put(&server, 0).await;
    server
}

#[tokio::test(flavor = "multi_thread")]
async fn a_backup_beside_a_writing_server_has_all_that_was_acknowledged() {
    let at = Arc::new(Places::new());
    let server = server_with_a_map(&at.database).await;
    let acknowledged = Arc::new(AtomicU64::new(1));
    let (api, total) = (server.api().clone(), acknowledged.clone());
    let writing = tokio::spawn(async move {
        for number in 1.. {
            let path = format!("/v1/maps/tower/keyframes/kf-{number}");
            assert_eq!(api.put(&path, &keyframe("a", number)).await.status, 201);
            total.store(number + 1, Ordering::SeqCst);
        }
    });
    for round in 0..3 {
        let before = acknowledged.load(Ordering::SeqCst);
        let to = at.clone();
        let take = move || to.run("backup", &["--force"]).well();
        let told = tokio::task::spawn_blocking(take).await.unwrap();
        let found = sound(&at.backup).await;
        let held = found.holds.unwrap();
        assert!(held.keyframes >= before, "round {round}: {} of {before}", held.keyframes);
        assert!(told.contains(&format!("1 map, {}", counted(held.keyframes, "keyframe"))), "{told}");
    }
    writing.abort();
    let metrics = server.api().get("/metrics").await.text();
    assert!(!metrics.contains("revisit_newest_backup_seconds 0\n"), "the server knows of it: {metrics}");
    assert!(
        !names(at.folder.path()).iter().any(|name| name.contains("partial")),
        "{:?}",
        names(at.folder.path())
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn a_backup_replaces_nothing_unless_told_to() {
    let at = Places::new();
    at.run("backup", &[]).refused("there is no database");
    let mut server = server_with_a_map(&at.database).await;
    revisit(&["backup", "--database", &url(&at.database), &at.database.display().to_string(), "--force"])
        .refused("the database itself");
    for part in ["revisit.db-wal", "revisit.db-reserve", "revisit.db.lock"] {
        let part = at.folder.path().join(part).display().to_string();
        revisit(&["backup", "--database", &url(&at.database), &part, "--force"]).refused("a part of it");
    }
    std::fs::write(&at.backup, "precious").unwrap();
    at.run("backup", &[]).refused("exists; --force replaces it");
    assert_eq!(std::fs::read(&at.backup).unwrap(), b"precious");
    at.run("backup", &["--force"]).well();
    assert_eq!(checked(&at.backup).await.holds.unwrap().keyframes, 1);
    let missing = at.folder.path().join("no/such/folder/backup.db").display().to_string();
    revisit(&["backup", "--database", &url(&at.database), &missing]).refused("No such file or directory");
    server.kill();
}

#[tokio::test(flavor = "multi_thread")]
async fn one_server_has_a_database_and_nobody_restores_under_it() {
    let at = Places::new();
    let mut server = server_with_a_map(&at.database).await;
    at.run("backup", &[]).well();
    revisit(&["serve", "--listen", "127.0.0.1:0", "--database", &url(&at.database)])
        .refused("is in use (by `serve, process");
    at.run("restore", &["--force"]).refused("is in use");
    assert!(server.terminate().success());
    at.run("restore", &[]).refused("exists; --force replaces it");
    // The lock goes with its process, however that ended.
    let mut server = Server::start(&at.database);
    server.kill();
    let mut server = Server::start(&at.database);
    assert!(server.terminate().success());
}

#[tokio::test(flavor = "multi_thread")]
async fn a_restored_backup_is_served_and_the_previous_database_is_kept_whole() {
    let at = Places::new();
    let mut server = server_with_a_map(&at.database).await;
    let before = server.api().get("/v1/maps/tower/keyframes/kf-0").await.body;
    at.run("backup", &[]).well();
    for number in 1..6 {
        put(&server, number).await;
    }
    // Killed: what was written last is in the log only.
    server.kill();
    assert!(names(at.folder.path()).contains("revisit.db-wal"));
    let told = at.run("restore", &["--force"]).well();
    assert!(told.contains("1 map, 1 keyframe,"), "{told}");
    let kept = told.lines().find_map(|line| line.strip_prefix("previous database: ")).unwrap();
    let kept = sound(Path::new(kept)).await;
    assert_eq!(kept.holds.unwrap().keyframes, 6, "the log came along");

    let mut server = Server::start(&at.database);
    assert_eq!(server.api().get("/v1/maps/tower/keyframes/kf-0").await.body, before);
    assert_eq!(server.api().get("/v1/maps/tower/keyframes/kf-1").await.status, 404);
    put(&server, 1).await;
    assert!(server.terminate().success());
    assert!(
        !names(at.folder.path()).contains("revisit.db-wal"),
        "a clean stop brings the log into the database"
    );
    sound(&at.database).await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_restore_that_broke_off_costs_the_database_before_it_nothing() {
    let at = Places::new();
    let mut server = server_with_a_map(&at.database).await;
    at.run("backup", &[]).well();
    put(&server, 1).await;
    server.kill();
    // Killed after it gave the log a second name, and before it gave the database one: at any of these seconds.
    let now = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH).unwrap().as_secs();
    for second in now..now + 60 {
        let name = at.folder.path().join(format!("revisit.db.before-{second}-wal"));
        std::fs::hard_link(at.folder.path().join("revisit.db-wal"), name).unwrap();
    }
    let told = at.run("restore", &["--force"]).well();
    let kept = told.lines().find_map(|line| line.strip_prefix("previous database: ")).unwrap();
    assert_eq!(checked(Path::new(kept)).await.holds.unwrap().keyframes, 2, "with what was in its log only");
}

#[tokio::test(flavor = "multi_thread")]
async fn a_damaged_backup_is_not_restored() {
    let at = Places::new();
    let mut server = server_with_a_map(&at.database).await;
    at.run("backup", &[]).well();
    assert!(server.terminate().success());
    let mut bytes = std::fs::read(&at.backup).unwrap();
    let middle = bytes.len() / 2 / 16384 * 16384;
    bytes[middle..middle + 64].fill(0xff);
    std::fs::write(&at.backup, &bytes).unwrap();
    let untouched = (names(at.folder.path()), std::fs::read(&at.database).unwrap());
    at.run("restore", &["--force"]).refused("cannot be restored");
    assert!(untouched == (names(at.folder.path()), std::fs::read(&at.database).unwrap()));
    // Into a place where nothing is, a sound one goes without being forced.
    let (elsewhere, sound) = (at.folder.path().join("elsewhere.db"), at.folder.path().join("sound.db"));
    revisit(&["backup", "--database", &url(&at.database), &sound.display().to_string()]).well();
    revisit(&["restore", "--database", &url(&elsewhere), &sound.display().to_string()]).well();
    assert_eq!(checked(&elsewhere).await.holds.unwrap().keyframes, 1);
}
