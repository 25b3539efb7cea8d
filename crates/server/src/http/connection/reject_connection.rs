//! Rejects a connection for which there is no slot, with a problem document.

use std::time::Duration;

use tokio::io::{AsyncReadExt as _, AsyncWriteExt as _};
use tokio::net::TcpStream;
use tokio::sync::OwnedSemaphorePermit;

/// Sent before the request is read, so it has no request id of the client's.
const ANSWER: &str = "HTTP/1.1 503 Service Unavailable\r\n\
    content-type: application/problem+json\r\n\
    retry-after: 1\r\n\
    connection: close\r\n\
    content-length: 190\r\n\
    x-content-type-options: nosniff\r\n\
    x-request-id: refused\r\n\r\n\
    {\"type\":\"/docs#problem-unavailable\",\"title\":\"The server is temporarily unavailable\",\"status\":503,\
    \"detail\":\"all connections are in use\",\"code\":\"overloaded\",\"request_id\":\"refused\",\"errors\":[]}";

/// Time for the client to read the response before the connection is closed.
const LINGER: Duration = Duration::from_secs(1);
/// Maximum bytes discarded meanwhile: closing with unread bytes would reset the connection and lose the response.
const DISCARDED_BYTES: u64 = 256 << 10;

/// Responds with 503 and closes.
pub async fn reject(mut stream: TcpStream, _permit: OwnedSemaphorePermit) {
    let told = async {
        stream.write_all(ANSWER.as_bytes()).await?;
        stream.shutdown().await?;
        tokio::io::copy(&mut (&mut stream).take(DISCARDED_BYTES), &mut tokio::io::sink()).await
    };
    // Closed whether or not the client has read it.
    let _ = tokio::time::timeout(LINGER, told).await;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_answer_says_how_long_it_is_and_is_a_problem() {
        let (head, body) = ANSWER.split_once("\r\n\r\n").unwrap();
        assert!(head.contains(&format!("content-length: {}\r\n", body.len())), "{}", body.len());
        let problem: serde_json::Value = serde_json::from_str(body).unwrap();
        assert_eq!(problem["status"], 503);
    }
}
