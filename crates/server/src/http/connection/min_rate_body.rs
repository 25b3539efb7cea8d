//! Minimum body rate: a request body must arrive at a minimum average rate, and without long pauses.
//!
//! Only the time in which the server waits for its client counts, so a client that sends faster than its lines are
//! stored is not limited. A gigabyte over a slow link may take hours, but an occasional byte does not keep a request
//! open.

use std::pin::Pin;
use std::sync::Arc;
use std::task::{Context, Poll};
use std::time::Duration;

use axum::BoxError;
use axum::body::{Body, Bytes, HttpBody};
use hyper::body::SizeHint;
use tokio::time::{Instant, Sleep, sleep_until};

use super::PolledFrame;
use crate::config::limits::LimitArgs;
use crate::engine::limits::load_shedding::RequestPermit;

/// The minimum speed of a body.
#[derive(Clone, Copy, Debug)]
pub struct MinRate {
    /// Time granted to every body, whatever was sent.
    grace: Duration,
    /// Maximum pause.
    stall: Duration,
    /// Bytes per second.
    rate: f64,
}

impl MinRate {
    /// Returns the operator's settings.
    pub fn of(limits: &LimitArgs) -> Self {
        let (grace, stall) = (limits.header_timeout, limits.stall_timeout);
        Self { grace, stall, rate: limits.min_body_rate as f64 }
    }

    /// Returns how much longer to wait for a body, given the time waited and the bytes received.
    fn patience(&self, waited: Duration, received: u64) -> Duration {
        let bought = Duration::try_from_secs_f64(received as f64 / self.rate).unwrap_or(Duration::MAX);
        self.grace.saturating_add(bought).saturating_sub(waited).min(self.stall)
    }
}

/// The body arrived too slowly.
#[derive(Debug, thiserror::Error)]
#[error("the body arrived too slowly")]
pub struct TooSlow;

/// A timed body.
pub struct MinRateBody {
    body: Body,
    pace: MinRate,
    /// The permit of its request, released while the server waits for the client.
    turn: Option<Arc<RequestPermit>>,
    waited: Duration,
    received: u64,
    waiting: Option<(Instant, Pin<Box<Sleep>>)>,
}

impl MinRateBody {
    /// Returns a body with a minimum rate.
    pub fn new(body: Body, pace: MinRate, turn: Option<Arc<RequestPermit>>) -> Self {
        Self { body, pace, turn, waited: Duration::ZERO, received: 0, waiting: None }
    }

    fn wait(&mut self, cx: &mut Context<'_>) -> Poll<()> {
        let (turn, pace, waited, received) = (&self.turn, self.pace, self.waited, self.received);
        let (_, timer) = self.waiting.get_or_insert_with(|| {
            if let Some(turn) = turn {
                turn.pause();
            }
            let now = Instant::now();
            (now, Box::pin(sleep_until(now + pace.patience(waited, received))))
        });
        timer.as_mut().poll(cx)
    }

    fn goes_on(&mut self) {
        if let Some((since, _)) = self.waiting.take() {
            self.waited += since.elapsed();
            if let Some(turn) = &self.turn {
                turn.resume();
            }
        }
    }
}

impl HttpBody for MinRateBody {
    type Data = Bytes;
    type Error = BoxError;

    fn poll_frame(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> PolledFrame<BoxError> {
        match Pin::new(&mut self.body).poll_frame(cx) {
            Poll::Pending => match self.wait(cx) {
                Poll::Pending => Poll::Pending,
                Poll::Ready(()) => {
                    self.goes_on();
                    Poll::Ready(Some(Err(TooSlow.into())))
                }
            },
            Poll::Ready(frame) => {
                self.goes_on();
                if let Some(Ok(frame)) = &frame {
                    self.received += frame.data_ref().map_or(0, |data| data.len() as u64);
                }
                Poll::Ready(frame.map(|frame| frame.map_err(Into::into)))
            }
        }
    }

    fn is_end_stream(&self) -> bool {
        self.body.is_end_stream()
    }

    fn size_hint(&self) -> SizeHint {
        self.body.size_hint()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sent_bytes_buy_time_and_no_pause_is_longer_than_the_longest() {
        let secs = Duration::from_secs;
        let pace = MinRate { grace: secs(5), stall: secs(30), rate: 1024.0 };
        assert_eq!(pace.patience(secs(0), 0), secs(5));
        assert_eq!(pace.patience(secs(4), 0), secs(1));
        assert_eq!(pace.patience(secs(9), 10 << 10), secs(6));
        assert_eq!(pace.patience(secs(9), 1 << 30), secs(30));
        assert_eq!(pace.patience(secs(90), 10 << 10), secs(0));
    }

    /// Simulates a body of equal chunks after equal pauses; returns its duration, or the time at which it was cut off.
    fn played(chunk: u64, every: Duration, chunks: u32) -> Result<Duration, Duration> {
        let pace = MinRate { grace: Duration::from_secs(5), stall: Duration::from_secs(30), rate: 1024.0 };
        let (mut waited, mut received) = (Duration::ZERO, 0);
        for _ in 0..chunks {
            let patience = pace.patience(waited, received);
            if patience < every {
                return Err(waited + patience);
            }
            waited += every;
            received += chunk;
        }
        Ok(waited)
    }

    #[test]
    fn a_byte_now_and_then_ends_and_a_slow_link_does_not() {
        let sec = Duration::from_secs(1);
        let cut = played(1, sec, 1000).expect_err("too slow");
        assert!(cut < 6 * sec, "{cut:?}");
        assert_eq!(played(2000, sec, 1000), Ok(1000 * sec));
        assert_eq!(played(1 << 20, 31 * sec, 2), Err(5 * sec));
    }

    #[tokio::test]
    async fn a_body_that_does_not_arrive_ends_after_its_time() {
        use http_body_util::BodyExt as _;

        let (grace, stall) = (Duration::from_millis(20), Duration::from_secs(30));
        let never = Body::from_stream(futures_util::stream::pending::<std::io::Result<Bytes>>());
        let started = Instant::now();
        let ended = MinRateBody::new(never, MinRate { grace, stall, rate: 1024.0 }, None).collect().await;
        assert!(ended.expect_err("too slow").is::<TooSlow>());
        assert!(started.elapsed() >= grace);
    }
}
