//! Races: requests about one thing at the same time, each answered as if it had come alone, in some order.

use futures_util::future::join_all;

use crate::support::Server;

#[tokio::test(flavor = "multi_thread", worker_threads = 4)]
async fn a_put_that_races_a_delete_stores_the_keyframe_or_finds_it() {
    let server = Server::with_map("m").await;
    let path = "/v1/maps/m/keyframes/kf-1";
    for _ in 0..100 {
        let puts = async { join_all((0..8).map(|_| server.put_keyframe(path))).await };
        let deletes = async { join_all((0..4).map(|_| server.delete(path))).await };
        let (puts, deletes) = futures_util::future::join(puts, deletes).await;
        for put in puts {
            assert!([200, 201].contains(&put.status.as_u16()), "{put:#?}");
        }
        for delete in deletes {
            assert!([200, 404].contains(&delete.status.as_u16()), "{delete:#?}");
        }
    }
}
