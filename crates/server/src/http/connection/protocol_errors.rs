//! Protocol errors: hyper's own responses to malformed or oversized heads, rewritten as problem documents.
//!
//! hyper has no hook for them: it writes a bare 400, 414 or 431 and closes. It writes these only when every delivered
//! request is answered and every response is written out. This identifies them without parsing the output.

use std::io::{self, IoSlice};
use std::pin::Pin;
use std::task::{Context, Poll, ready};

use axum::http::StatusCode;
use bytes::{Buf as _, Bytes};
use tokio::io::AsyncWrite as _;
use tokio::net::TcpStream;

use super::connection_limit::{ConnectionSlot, Phase};
use crate::http::envelope::{REQUEST_ID, RequestId};
use crate::http::problem::{Kind, Problem};

/// Position of the status: `HTTP/1.1 400 `.
const STATUS: std::ops::Range<usize> = 9..12;

/// Writes what hyper writes, but its own error responses with a problem document.
#[derive(Default)]
pub struct ProtocolErrors {
    /// The number of requests delivered when the last response was completely written.
    settled: u64,
    /// The rest of what replaces a response of hyper's.
    instead: Option<Bytes>,
}

impl ProtocolErrors {
    /// Notes that hyper has written everything.
    pub fn flushed(&mut self, seat: &ConnectionSlot) {
        if matches!(seat.phase(), Phase::Waits { .. }) {
            self.settled = seat.requests();
        }
    }

    /// Writes what hyper writes; a problem document in place of its own response.
    pub fn poll_write(
        &mut self,
        mut stream: Pin<&mut TcpStream>,
        seat: &ConnectionSlot,
        cx: &mut Context<'_>,
        of_hyper: &[IoSlice<'_>],
    ) -> Poll<io::Result<usize>> {
        let answers_no_request = self.instead.is_some() || seat.requests() == self.settled;
        if !answers_no_request {
            return stream.poll_write_vectored(cx, of_hyper);
        }
        let rest = self.instead.get_or_insert_with(|| {
            let hypers = of_hyper.iter().flat_map(|slice| slice.iter().copied()).collect();
            to_problem(hypers).into()
        });
        while !rest.is_empty() {
            match ready!(stream.as_mut().poll_write(cx, rest))? {
                0 => return Poll::Ready(Err(io::ErrorKind::WriteZero.into())),
                written => rest.advance(written),
            }
        }
        Poll::Ready(Ok(of_hyper.iter().map(|slice| slice.len()).sum()))
    }
}

/// Returns hyper's response with a problem document as its body.
fn to_problem(hypers: Vec<u8>) -> Vec<u8> {
    let Some(status) = hypers.get(STATUS).and_then(|status| StatusCode::from_bytes(status).ok()) else {
        return hypers;
    };
    let problem = match status {
        StatusCode::BAD_REQUEST => {
            Problem::new(Kind::BAD_REQUEST, "the request's head is not valid HTTP/1.1")
        }
        status => Problem::of_status(status),
    };
    let id = RequestId::next().to_string();
    tracing::debug!(request_id = id, status = status.as_u16(), "a request could not be read");
    let body = serde_json::to_vec(&problem.view(&id)).unwrap_or_default();
    let (length, id_of) = (format!("content-length: {}", body.len()), format!("{REQUEST_ID}: {id}"));
    let hypers = String::from_utf8_lossy(&hypers);
    let kept = hypers.lines().filter(|line| !line.is_empty() && !line.starts_with("content-length:"));
    let ours = [
        "content-type: application/problem+json",
        "x-content-type-options: nosniff",
        &length,
        &id_of,
        "\r\n",
    ];
    let head = kept.chain(ours).collect::<Vec<_>>().join("\r\n");
    [head.into_bytes(), body].concat()
}
