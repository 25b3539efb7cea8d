//! I/O timeouts: limits on the time that a connection waits for its client.
//!
//! hyper's own timer for heads also runs on idle connections, and it has none for responses that are not read. The
//! stream therefore reports reads and writes to the slot, and times its writes itself. What it writes goes through
//! [`ProtocolErrors`].
//!
//! Closing a connection with unread bytes resets it, and loses a response in transit. Closing therefore lingers: after
//! the last response, the stream reads and discards input until the client closes.

use std::io;
use std::mem::MaybeUninit;
use std::pin::Pin;
use std::sync::Arc;
use std::task::{Context, Poll, ready};
use std::time::Duration;

use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};
use tokio::net::TcpStream;
use tokio::time::{Instant, Sleep, sleep_until};

use super::connection_limit::{ConnectionSlot, Phase};
use super::protocol_errors::ProtocolErrors;
use crate::api::limits;
use crate::config::limits::LimitArgs;

/// Maximum time that a closed connection lingers.
const LINGER: Duration = Duration::from_secs(3);
/// Maximum time that it lingers while its client sends nothing.
const LINGER_SILENT: Duration = Duration::from_secs(1);
/// Maximum bytes that it reads while lingering: the largest body.
const LINGER_BYTES: usize = limits::BODY_BYTES;

/// Resolves when the client's request is overdue.
pub async fn overdue(seat: &ConnectionSlot, limits: &LimitArgs) {
    // Polled: the activity changes too often to wake a timer for each change.
    let again = limits.header_timeout / 4;
    loop {
        let now = Instant::now();
        let due = match seat.phase() {
            Phase::Waits { idle: true, since, .. } => since + limits.keep_alive,
            Phase::Waits { idle: false, since, .. } => since + limits.header_timeout,
            // The body of a request in progress has its own timer.
            Phase::Works => now + again,
        };
        if due <= now {
            return;
        }
        sleep_until(due.min(now + again)).await;
    }
}

/// A stream with the timeouts of its server, on which every error response has a problem document.
pub struct TimeoutStream {
    stream: TcpStream,
    seat: Arc<ConnectionSlot>,
    protocol_errors: ProtocolErrors,
    stall: Duration,
    writing: Option<Pin<Box<Sleep>>>,
    lingering: Option<Linger>,
}

/// A stream closed by this side.
struct Linger {
    end: Instant,
    timer: Pin<Box<Sleep>>,
    left: usize,
}

impl TimeoutStream {
    /// Returns the stream of the connection on this slot.
    pub fn new(stream: TcpStream, seat: Arc<ConnectionSlot>, limits: &LimitArgs) -> Self {
        let (protocol_errors, stall) = (ProtocolErrors::default(), limits.stall_timeout);
        Self { stream, seat, protocol_errors, stall, writing: None, lingering: None }
    }

    /// Starts or clears the write timer.
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
        Poll::Ready(Err(io::Error::new(io::ErrorKind::TimedOut, "the client does not read its response")))
    }
}

impl AsyncRead for TimeoutStream {
    fn poll_read(
        mut self: Pin<&mut Self>,
        cx: &mut Context<'_>,
        buffer: &mut ReadBuf<'_>,
    ) -> Poll<io::Result<()>> {
        let before = buffer.filled().len();
        let read = Pin::new(&mut self.stream).poll_read(cx, buffer);
        if buffer.filled().len() > before {
            self.seat.on_read();
        }
        read
    }
}

impl AsyncWrite for TimeoutStream {
    fn poll_write(self: Pin<&mut Self>, cx: &mut Context<'_>, bytes: &[u8]) -> Poll<io::Result<usize>> {
        self.poll_write_vectored(cx, &[io::IoSlice::new(bytes)])
    }

    fn poll_write_vectored(
        mut self: Pin<&mut Self>,
        cx: &mut Context<'_>,
        slices: &[io::IoSlice<'_>],
    ) -> Poll<io::Result<usize>> {
        let Self { stream, seat, protocol_errors, .. } = &mut *self;
        let written = protocol_errors.poll_write(Pin::new(stream), seat, cx, slices);
        self.watch_writing(cx, written)
    }

    fn is_write_vectored(&self) -> bool {
        self.stream.is_write_vectored()
    }

    fn poll_flush(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        let Self { stream, seat, protocol_errors, .. } = &mut *self;
        protocol_errors.flushed(seat);
        Pin::new(stream).poll_flush(cx)
    }

    fn poll_shutdown(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        if self.lingering.is_none() {
            ready!(Pin::new(&mut self.stream).poll_shutdown(cx))?;
            self.lingering = Some(Linger::from_now());
        }
        let Self { stream, lingering, .. } = &mut *self;
        match lingering {
            Some(linger) => linger.poll(stream, cx).map(Ok),
            None => Poll::Ready(Ok(())),
        }
    }
}

impl Linger {
    fn from_now() -> Self {
        let now = Instant::now();
        let timer = Box::pin(sleep_until(now + LINGER_SILENT));
        Self { end: now + LINGER, timer, left: LINGER_BYTES }
    }

    /// Reads and discards until the client closes or its time is over.
    fn poll(&mut self, stream: &mut TcpStream, cx: &mut Context<'_>) -> Poll<()> {
        let mut forgotten = [MaybeUninit::uninit(); 8 << 10];
        loop {
            let mut buffer = ReadBuf::uninit(&mut forgotten);
            match Pin::new(&mut *stream).poll_read(cx, &mut buffer) {
                Poll::Pending => return self.timer.as_mut().poll(cx),
                Poll::Ready(Err(_)) => return Poll::Ready(()),
                Poll::Ready(Ok(())) => {}
            }
            let now = Instant::now();
            let read = buffer.filled().len();
            self.left = self.left.saturating_sub(read);
            if read == 0 || self.left == 0 || now > self.end {
                return Poll::Ready(());
            }
            self.timer.as_mut().reset(self.end.min(now + LINGER_SILENT));
        }
    }
}
