//! Lives: a map is made, used and deleted by clients that do not wait for each other, and is never in memory twice.

use std::str::FromStr as _;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use revisit::api::verdict::LoopAnswer;
use revisit::domain::map::MapProperties;
use revisit::engine::{Service, ServiceError, ServiceOptions};
use serde_json::json;
use sqlx::sqlite::SqliteConnectOptions;
use sqlx::{ConnectOptions as _, Executor as _};

use crate::support::{Server, keyframe};

#[tokio::test(flavor = "multi_thread")]
async fn writes_sent_while_their_map_is_made_stay() {
    let server = Arc::new(Server::start().await);
    for number in 0..60 {
        let map = format!("/v1/maps/m{number}");
        let made = Arc::new(AtomicBool::new(false));
        let robots: Vec<_> = (0..3)
            .map(|robot| {
                let (server, made, path) =
                    (server.clone(), made.clone(), format!("{map}/keyframes/early-{robot}"));
                tokio::spawn(async move {
                    loop {
                        let last = made.load(Ordering::SeqCst);
                        let status = server.put(&path, &keyframe()).await.status.as_u16();
                        match status {
                            201 => return,
                            404 if !last => {}
                            other => panic!("{path}: {other}"),
                        }
                    }
                })
            })
            .collect();
        server.put(&map, &json!({})).await.expect(201);
        made.store(true, Ordering::SeqCst);
        for robot in robots {
            robot.await.expect("a robot whose keyframe is taken");
        }
        server.put(&format!("{map}/keyframes/late"), &keyframe()).await.expect(201);
        let map = server.get(&map).await.expect(200);
        assert_eq!((&map["keyframes"], &map["map_version"]), (&json!(4), &json!(5)));
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn a_deletion_goes_to_its_end_when_its_client_has_gone() {
    let folder = tempfile::tempdir().unwrap();
    let database = crate::support::database_in(folder.path()).await;
    let service = Service::open(ServiceOptions::on(database, LoopAnswer::bytes)).await.unwrap();
    let id = revisit::domain::ids::MapId::from_str("m").unwrap();
    let mut finished = 0;
    for polls in 0..12 {
        let stored = service.put_map(id.clone(), MapProperties::default(), None).await.unwrap();
        assert!(stored.created, "after a deletion given up at poll {polls}");
        {
            let mut deleting = Box::pin(service.delete_map(&id));
            for _ in 0..polls {
                tokio::select! {
                    biased;
                    done = &mut deleting => {
                        done.unwrap();
                        finished += 1;
                        break;
                    }
                    () = tokio::task::yield_now() => {}
                }
            }
        }
        // Whether it had begun or not: the name is good for deleting, reading and a new map.
        let again = service.delete_map(&id).await;
        assert!(matches!(again, Ok(()) | Err(ServiceError::NotFound(_))), "{again:?}");
        assert!(service.get_map(&id).await.is_err());
    }
    assert!(finished < 12, "some were given up");
    service.close().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn writes_that_wait_for_a_slow_disk_are_counted_and_bounded() {
    let folder = tempfile::tempdir().unwrap();
    let server = Arc::new(Server::on(folder.path()).await);
    server.put("/v1/maps/m", &json!({})).await.expect(201);
    server.put_keyframe("/v1/maps/m/keyframes/kf").await.expect(201);
    // As slow as a disk can be: the lock to write is somebody else's.
    let file = folder.path().join("test.db");
    let mut disk = SqliteConnectOptions::new().filename(file).connect().await.unwrap();
    disk.execute("begin immediate").await.unwrap();

    let question = json!({"keyframe": "kf"});
    for _ in 0..50 {
        server.post("/v1/maps/m/loop-queries", &question).await.expect(200);
    }
    assert_eq!(server.figure("revisit_queue_depth").await, 1, "one answer waits, however often it was given");

    let writers: Vec<_> = (0..20)
        .map(|number| {
            let server = server.clone();
            tokio::spawn(
                async move { server.put_keyframe(&format!("/v1/maps/m/keyframes/kf-{number}")).await },
            )
        })
        .collect();
    while server.figure("revisit_queue_depth").await < 21 {
        tokio::task::yield_now().await;
    }
    for writer in writers {
        writer.abort();
        let _ = writer.await;
    }
    while server.figure("revisit_requests_in_flight").await > 1 {
        tokio::task::yield_now().await;
    }
    assert_eq!(server.figure("revisit_writes_under_way").await, 20, "their clients have gone, they have not");
    disk.execute("rollback").await.unwrap();
    while server.figure("revisit_writes_under_way").await > 0 {
        tokio::task::yield_now().await;
    }
    assert_eq!(server.get("/v1/maps/m").await.expect(200)["keyframes"], 21);
}
