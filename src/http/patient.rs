//! Patient: how long a connection waits for its client.
//!
//! hyper's own timer for heads also runs while a connection is idle, and it has none for answers that nobody takes. So
//! the stream tells the seat what it hears and says, and is timed itself where it writes.

use std::io;
use std::pin::Pin;
use std::sync::Arc;
use std::task::{Context, Poll, ready};
use std::time::Duration;

use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};
use tokio::time::{Instant, Sleep, sleep_until};

use super::seats::{Phase, Seat};
use crate::config::limits::LimitArgs;

/// Resolves when the client should have sent a request long since.
pub async fn overdue(seat: &Seat, limits: &LimitArgs) {
    // Looked at again and again: what a connection is about changes more often than this, and costs nothing so.
    let again = limits.header_timeout / 4;
    loop {
        let now = Instant::now();
        let due = match seat.phase() {
            Phase::Waits { idle: true, since, .. } => since + limits.keep_alive,
            Phase::Waits { idle: false, since, .. } => since + limits.header_timeout,
            // While a request is worked on, its body has a timer of its own.
            Phase::Works => now + again,
        };
        if due <= now {
            return;
        }
        sleep_until(due.min(now + again)).await;
    }
}

/// A stream with the patience of its server.
pub struct Patient<S> {
    stream: S,
    seat: Arc<Seat>,
    stall: Duration,
    writing: Option<Pin<Box<Sleep>>>,
}

impl<S> Patient<S> {
    /// The stream of the connection on this seat.
    pub fn new(stream: S, seat: Arc<Seat>, limits: &LimitArgs) -> Self {
        Self { stream, seat, stall: limits.stall_timeout, writing: None }
    }

    /// Something could be written, or nothing.
    fn watch_writing(
        &mut self,
        cx: &mut Context<'_>,
        written: Poll<io::Result<usize>>,
    ) -> Poll<io::Result<usize>> {
        if written.is_ready() {
            self.writing = None;
            self.seat.speaks();
            return written;
        }
        let stall = self.stall;
        let timer = self.writing.get_or_insert_with(|| Box::pin(sleep_until(Instant::now() + stall)));
        ready!(timer.as_mut().poll(cx));
        Poll::Ready(Err(io::Error::new(io::ErrorKind::TimedOut, "the client does not take its answer")))
    }
}

impl<S: AsyncRead + Unpin> AsyncRead for Patient<S> {
    fn poll_read(
        mut self: Pin<&mut Self>,
        cx: &mut Context<'_>,
        buffer: &mut ReadBuf<'_>,
    ) -> Poll<io::Result<()>> {
        let before = buffer.filled().len();
        let read = Pin::new(&mut self.stream).poll_read(cx, buffer);
        if buffer.filled().len() > before {
            self.seat.hears();
        }
        read
    }
}

impl<S: AsyncWrite + Unpin> AsyncWrite for Patient<S> {
    fn poll_write(mut self: Pin<&mut Self>, cx: &mut Context<'_>, bytes: &[u8]) -> Poll<io::Result<usize>> {
        let written = Pin::new(&mut self.stream).poll_write(cx, bytes);
        self.watch_writing(cx, written)
    }

    fn poll_write_vectored(
        mut self: Pin<&mut Self>,
        cx: &mut Context<'_>,
        slices: &[io::IoSlice<'_>],
    ) -> Poll<io::Result<usize>> {
        let written = Pin::new(&mut self.stream).poll_write_vectored(cx, slices);
        self.watch_writing(cx, written)
    }

    fn is_write_vectored(&self) -> bool {
        self.stream.is_write_vectored()
    }

    fn poll_flush(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.stream).poll_flush(cx)
    }

    fn poll_shutdown(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.stream).poll_shutdown(cx)
    }
}
