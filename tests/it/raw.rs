//! Raw: bytes to a server and bytes back, for requests that no client library would send.

use std::net::SocketAddr;

use tokio::io::{AsyncReadExt as _, AsyncWriteExt as _};
use tokio::net::TcpStream;

/// A connection without a client on top.
pub struct Connection(TcpStream);

impl Connection {
    pub async fn open(addr: SocketAddr) -> Self {
        Self(TcpStream::connect(addr).await.expect("a connection"))
    }

    /// Sends bytes; a server that has closed already takes none, and what it answered says more.
    pub async fn send(&mut self, bytes: impl AsRef<[u8]>) {
        let _ = self.0.write_all(bytes.as_ref()).await;
    }

    /// Everything until the server closes.
    pub async fn rest(&mut self) -> String {
        let mut all = Vec::new();
        // A reset after the answer is an end, too.
        let _ = self.0.read_to_end(&mut all).await;
        String::from_utf8_lossy(&all).into_owned()
    }

    /// One answer's head, and as much of its body as came along.
    pub async fn head(&mut self) -> String {
        let mut head = Vec::new();
        while !head.windows(4).any(|four| four == b"\r\n\r\n") {
            if self.0.read_buf(&mut head).await.unwrap_or(0) == 0 {
                break;
            }
        }
        String::from_utf8_lossy(&head).into_owned()
    }
}

/// The statuses of all answers in what a server sent.
pub fn statuses(answers: &str) -> Vec<u16> {
    let lines = answers.split("HTTP/1.").skip(1);
    lines.filter_map(|line| line.get(2..5)?.parse().ok()).collect()
}
