//! Protocol errors: hyper's own responses to malformed or oversized heads, rewritten as problem documents.
//!
//! hyper has no hook for them: it writes a bare 400, 414 or 431 and closes. It writes these only when every delivered
//! request is answered and every response is written out. This identifies them without parsing the output.

use std::io::{self, IoSlice};
use std::pin::Pin;
use std::sync::Arc;
use std::task::{Context, Poll, ready};

use axum::http::StatusCode;
use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};

use super::connection_limit::{ConnectionSlot, Phase};
use crate::http::envelope::{REQUEST_ID, RequestId};
use crate::http::problem::{Kind, Problem};

/// Position of the status: `HTTP/1.1 400 `.
const STATUS: std::ops::Range<usize> = 9..12;

/// A stream on which every error response has a problem document.
pub struct ProtocolErrors<S> {
    stream: S,
    seat: Arc<ConnectionSlot>,
    /// The number of requests delivered when the last response was completely written.
    settled: u64,
    instead: Option<Instead>,
}

/// The replacement of a response of hyper's.
struct Instead {
    bytes: Vec<u8>,
    written: usize,
}

impl<S> ProtocolErrors<S> {
    /// Returns the stream of the connection on this slot.
    pub fn new(stream: S, seat: Arc<ConnectionSlot>) -> Self {
        Self { stream, seat, settled: 0, instead: None }
    }

    /// Whether these bytes answer no request.
    fn is_hypers_own(&self) -> bool {
        self.instead.is_some() || self.seat.requests() == self.settled
    }
}

impl<S: AsyncWrite + Unpin> ProtocolErrors<S> {
    /// Writes a problem document in place of hyper's response.
    fn poll_instead(&mut self, cx: &mut Context<'_>, of_hyper: &[IoSlice<'_>]) -> Poll<io::Result<usize>> {
        let instead = self.instead.get_or_insert_with(|| {
            let hypers = of_hyper.iter().flat_map(|slice| slice.iter().copied()).collect();
            Instead { bytes: to_problem(hypers), written: 0 }
        });
        while let Some(rest) = instead.bytes.get(instead.written..).filter(|rest| !rest.is_empty()) {
            match ready!(Pin::new(&mut self.stream).poll_write(cx, rest))? {
                0 => return Poll::Ready(Err(io::ErrorKind::WriteZero.into())),
                written => instead.written += written,
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

impl<S: AsyncRead + Unpin> AsyncRead for ProtocolErrors<S> {
    fn poll_read(
        mut self: Pin<&mut Self>,
        cx: &mut Context<'_>,
        buffer: &mut ReadBuf<'_>,
    ) -> Poll<io::Result<()>> {
        Pin::new(&mut self.stream).poll_read(cx, buffer)
    }
}

impl<S: AsyncWrite + Unpin> AsyncWrite for ProtocolErrors<S> {
    fn poll_write(mut self: Pin<&mut Self>, cx: &mut Context<'_>, bytes: &[u8]) -> Poll<io::Result<usize>> {
        if self.is_hypers_own() {
            return self.poll_instead(cx, &[IoSlice::new(bytes)]);
        }
        Pin::new(&mut self.stream).poll_write(cx, bytes)
    }

    fn poll_write_vectored(
        mut self: Pin<&mut Self>,
        cx: &mut Context<'_>,
        slices: &[IoSlice<'_>],
    ) -> Poll<io::Result<usize>> {
        if self.is_hypers_own() {
            return self.poll_instead(cx, slices);
        }
        Pin::new(&mut self.stream).poll_write_vectored(cx, slices)
    }

    fn is_write_vectored(&self) -> bool {
        self.stream.is_write_vectored()
    }

    /// hyper calls this once it has written everything.
    fn poll_flush(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        if matches!(self.seat.phase(), Phase::Waits { .. }) {
            self.settled = self.seat.requests();
        }
        Pin::new(&mut self.stream).poll_flush(cx)
    }

    fn poll_shutdown(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.stream).poll_shutdown(cx)
    }
}
