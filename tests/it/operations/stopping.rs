//! Stopping: a server that is told to goes on for a while, if it shall.

use serde_json::json;

use crate::raw::{Connection, statuses};
use crate::support::Server;

#[tokio::test(flavor = "multi_thread")]
async fn a_server_that_is_told_to_stop_goes_on_while_a_balancer_notices() {
    let (server, _) = Server::within(&["--drain", "3600"]).await;
    server.put("/v1/maps/m", &json!({})).await.expect(201);
    server.get("/readyz").await.expect(200);
    server.tell_to_stop();
    // On connections of their own, as a balancer and its clients come.
    for (path, status) in [("/readyz", 503), ("/healthz", 200), ("/v1/maps/m", 200)] {
        let mut connection = Connection::open(server.addr()).await;
        connection.send(format!("GET {path} HTTP/1.1\r\nhost: localhost\r\nconnection: close\r\n\r\n")).await;
        assert_eq!(statuses(&connection.rest().await), [status], "{path}");
    }
}
