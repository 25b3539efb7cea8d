//! Patient: a connection's stream that waits for its client, but not for ever.
//!
//! hyper's own timer for heads also runs while a connection is idle, and it has none for answers that nobody takes; so
//! the stream itself knows what its connection is about (the seat tells) and gives up when that takes too long.

use std::io;
use std::pin::Pin;
use std::sync::Arc;
use std::task::{Context, Poll, ready};
use std::time::Duration;

use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};
use tokio::time::{Instant, Sleep, sleep_until};

use super::seats::{Phase, Seat};
use crate::config::limits::LimitArgs;

/// A stream with the patience of its server.
pub struct Patient<S> {
    stream: S,
    seat: Arc<Seat>,
    head: Duration,
    idle: Duration,
    stall: Duration,
    reading: Pin<Box<Sleep>>,
    writing: Option<Pin<Box<Sleep>>>,
}

impl<S> Patient<S> {
    /// The stream of the connection on this seat.
    pub fn new(stream: S, seat: Arc<Seat>, limits: &LimitArgs) -> Self {
        Self {
            stream,
            seat,
            head: limits.header_timeout,
            idle: limits.keep_alive,
            stall: limits.stall_timeout,
            reading: Box::pin(sleep_until(Instant::now())),
            writing: None,
        }
    }

    /// Nothing is there to be read. Is that all right?
    fn waits_for_client(&mut self, cx: &mut Context<'_>) -> Poll<io::Error> {
        // While a request is worked on, its body has a timer of its own.
        let Phase::Waits { idle, since, .. } = self.seat.phase() else { return Poll::Pending };
        let deadline = since + if idle { self.idle } else { self.head };
        if self.reading.deadline() != deadline {
            self.reading.as_mut().reset(deadline);
        }
        ready!(self.reading.as_mut().poll(cx));
        Poll::Ready(io::Error::new(io::ErrorKind::TimedOut, "the client sent no request in time"))
    }

    /// Nothing could be written, or something could.
    fn watch_writing<T>(
        &mut self,
        cx: &mut Context<'_>,
        written: Poll<io::Result<T>>,
    ) -> Poll<io::Result<T>> {
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
        match Pin::new(&mut self.stream).poll_read(cx, buffer) {
            Poll::Pending => self.waits_for_client(cx).map(Err),
            Poll::Ready(result) => {
                if buffer.filled().len() > before {
                    self.seat.hears();
                }
                Poll::Ready(result)
            }
        }
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
