//! Stopping: a server that is told to goes on for a while, if it shall.

use std::io::{BufRead as _, BufReader, ErrorKind, Read as _, Write as _};
use std::net::{SocketAddr, TcpStream};
use std::sync::atomic::{AtomicUsize, Ordering};

use serde_json::json;

use crate::crash;
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

/// An address of this machine that no other test uses.
const OWN_ADDRESS: &str = if cfg!(target_os = "linux") { "127.0.0.7:0" } else { "127.0.0.1:0" };
/// Clients under load, half of which keep their connections.
const CLIENTS: usize = 8;

/// Sends a request; whether the server said that it closes the connection.
fn ask(connection: &mut BufReader<TcpStream>, closes: bool) -> std::io::Result<bool> {
    let last = if closes { "connection: close\r\n" } else { "" };
    let body = "{}";
    let length = body.len();
    let request = format!(
        "PUT /v1/maps/m HTTP/1.1\r\nhost: localhost\r\ncontent-type: application/json\r\n{last}content-length: {length}\r\n\r\n{body}"
    );
    connection.get_mut().write_all(request.as_bytes())?;
    let (mut length, mut is_last, mut line) = (0, false, String::new());
    while line != "\r\n" {
        line.clear();
        if connection.read_line(&mut line)? == 0 {
            return Err(ErrorKind::UnexpectedEof.into());
        }
        is_last |= line == "connection: close\r\n";
        length =
            line.strip_prefix("content-length: ").map_or(length, |text| text.trim_end().parse().unwrap());
    }
    let mut body = vec![0; length];
    connection.read_exact(&mut body)?;
    Ok(is_last)
}

/// Asks until no new connection is to be had.
fn load(addr: SocketAddr, keeps: bool, answered: &AtomicUsize) -> std::io::Result<()> {
    loop {
        let mut connection = match TcpStream::connect(addr) {
            Ok(stream) => BufReader::new(stream),
            Err(error) if error.kind() == ErrorKind::ConnectionRefused => return Ok(()),
            Err(error) => return Err(error),
        };
        while !ask(&mut connection, !keeps)? {
            answered.fetch_add(1, Ordering::Relaxed);
        }
        answered.fetch_add(1, Ordering::Relaxed);
    }
}

#[test]
fn under_load_a_server_that_stops_answers_every_request_and_resets_no_connection() {
    let folder = tempfile::tempdir().unwrap();
    for round in 0..3 {
        // Where no other test listens: a port that is free again may be another server's a moment later.
        let database = folder.path().join(format!("{round}.db"));
        let mut server = crash::server::Server::start_with(&database, &["--listen", OWN_ADDRESS]);
        let addr = server.api().addr();
        let answered = AtomicUsize::new(0);
        let (status, ends) = std::thread::scope(|scope| {
            let answered = &answered;
            let clients: Vec<_> = (0..CLIENTS)
                .map(|number| scope.spawn(move || load(addr, number % 2 == 0, answered)))
                .collect();
            while answered.load(Ordering::Relaxed) < 50 * CLIENTS {
                std::thread::yield_now();
            }
            let status = server.terminate();
            (status, clients.into_iter().map(|client| client.join().unwrap()).collect::<Vec<_>>())
        });
        assert!(status.success());
        assert!(ends.iter().all(Result::is_ok), "round {round}: {ends:?}");
    }
}
