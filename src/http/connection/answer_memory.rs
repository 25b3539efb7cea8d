//! Answer memory: a bound on the bytes of large answers that their clients have not taken yet.
//!
//! An answer stays in memory until its last byte has left, and a client that does not read keeps it there. Where the
//! answers of all connections together would take more than is allowed, the connection that has taken nothing for longest
//! is closed for the new answer. Where all of them are being taken, the new one is refused.

use std::collections::BTreeMap;
use std::pin::Pin;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::task::{Context, Poll, ready};
use std::time::Duration;

use axum::body::{Body, Bytes, HttpBody};
use axum::extract::{Request, State};
use axum::middleware::Next;
use axum::response::{IntoResponse as _, Response};
use hyper::body::{Frame, SizeHint};
use tokio::time::Instant;

use super::connection_limit::ConnectionSlot;
use crate::http::App;
use crate::http::problem::Problem;

/// Answers up to this size are not counted: their number is bounded by that of connections.
const UNCOUNTED_BYTES: u64 = 64 << 10;
/// A large answer leaves in pieces of this size, so that it is known whether its client takes it.
const PIECE_BYTES: usize = 64 << 10;
/// A client that has taken a piece within this time keeps its answer.
const STALLED_AFTER: Duration = Duration::from_secs(1);

/// The memory that large answers share.
#[derive(Debug)]
pub struct AnswerMemory {
    most: usize,
    held: Mutex<HeldMemory>,
}

#[derive(Debug, Default)]
struct HeldMemory {
    bytes: usize,
    /// The numbers grow with time: the first is the one of which nothing was taken for longest.
    answers: BTreeMap<u64, Leaving>,
    next: u64,
}

#[derive(Debug)]
struct Leaving {
    bytes: usize,
    taken: Instant,
    seat: Arc<ConnectionSlot>,
}

/// The place of one answer in the shared memory, until this is dropped.
#[derive(Debug)]
struct Share {
    memory: Arc<AnswerMemory>,
    number: u64,
}

impl AnswerMemory {
    /// Creates a memory of this many MiB.
    pub fn new(mebibytes: usize) -> Arc<Self> {
        Arc::new(Self { most: mebibytes.saturating_mul(1 << 20), held: Mutex::default() })
    }

    /// Takes memory for an answer, and says how many connections, whose clients take nothing, are closed for it.
    fn take(self: &Arc<Self>, bytes: usize, seat: &Arc<ConnectionSlot>) -> (Option<Share>, usize) {
        let mut held = self.lock();
        let mut evictions = 0;
        // An answer larger than the whole memory leaves when it is the only one.
        while held.bytes > 0 && held.bytes.saturating_add(bytes) > self.most {
            let stalled = held.answers.first_entry().filter(|first| {
                let Leaving { taken, .. } = first.get();
                taken.elapsed() > STALLED_AFTER
            });
            let Some(stalled) = stalled else { return (None, evictions) };
            let evicted = stalled.remove();
            held.bytes -= evicted.bytes;
            evicted.seat.request_close();
            evictions += 1;
        }
        held.bytes += bytes;
        let number = held.add(Leaving { bytes, taken: Instant::now(), seat: seat.clone() });
        (Some(Share { memory: self.clone(), number }), evictions)
    }

    fn lock(&self) -> MutexGuard<'_, HeldMemory> {
        // A table of numbers is whole after each of its operations.
        self.held.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl HeldMemory {
    fn add(&mut self, leaving: Leaving) -> u64 {
        self.next += 1;
        self.answers.insert(self.next, leaving);
        self.next
    }
}

impl Share {
    /// Notes that the client has taken a piece.
    fn taken(&mut self) {
        let mut held = self.memory.lock();
        if let Some(leaving) = held.answers.remove(&self.number) {
            self.number = held.add(Leaving { taken: Instant::now(), ..leaving });
        }
    }
}

impl Drop for Share {
    fn drop(&mut self) {
        let mut held = self.memory.lock();
        // One that was evicted is not there any more.
        if let Some(leaving) = held.answers.remove(&self.number) {
            held.bytes -= leaving.bytes;
        }
    }
}

/// Middleware that counts large answers, and refuses those for which there is no memory.
pub async fn bound_answers(State(app): State<App>, request: Request, next: Next) -> Response {
    let seat = request.extensions().get::<Arc<ConnectionSlot>>().cloned();
    let response = next.run(request).await;
    // A stream has no length, and holds an event at a time.
    let length = response.body().size_hint().exact().filter(|length| *length > UNCOUNTED_BYTES);
    let (Some(seat), Some(length)) = (seat, length) else { return response };
    let (share, evictions) = app.answers.take(length as usize, &seat);
    (0..evictions).for_each(|_| app.metrics.shed_metrics.connection("evicted"));
    let Some(share) = share else {
        app.metrics.shed_metrics.shed("answer");
        let detail = "answers that other clients have not taken yet hold all the memory for answers";
        return Problem::overloaded(detail).into_response();
    };
    response.map(|body| Body::new(Pieces { body, rest: Bytes::new(), share }))
}

/// A body that leaves piece by piece.
struct Pieces {
    body: Body,
    rest: Bytes,
    share: Share,
}

impl HttpBody for Pieces {
    type Data = Bytes;
    type Error = axum::Error;

    fn poll_frame(
        mut self: Pin<&mut Self>,
        cx: &mut Context<'_>,
    ) -> Poll<Option<Result<Frame<Bytes>, axum::Error>>> {
        // The next piece is asked for when the one before it has left.
        self.share.taken();
        if self.rest.is_empty() {
            match ready!(Pin::new(&mut self.body).poll_frame(cx)) {
                Some(Ok(frame)) => match frame.into_data() {
                    Ok(data) => self.rest = data,
                    Err(trailers) => return Poll::Ready(Some(Ok(trailers))),
                },
                end => return Poll::Ready(end),
            }
        }
        let length = self.rest.len().min(PIECE_BYTES);
        Poll::Ready(Some(Ok(Frame::data(self.rest.split_to(length)))))
    }

    fn is_end_stream(&self) -> bool {
        self.rest.is_empty() && self.body.is_end_stream()
    }

    fn size_hint(&self) -> SizeHint {
        let length = self.body.size_hint().exact().map(|length| length + self.rest.len() as u64);
        length.map_or_else(SizeHint::default, SizeHint::with_exact)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::http::connection::connection_limit::ConnectionSlots;

    /// Lets all answers look as if their clients had taken nothing for this long.
    fn age(memory: &AnswerMemory, by: Duration) {
        for leaving in memory.lock().answers.values_mut() {
            leaving.taken = leaving.taken.checked_sub(by).unwrap();
        }
    }

    #[tokio::test]
    async fn evicts_the_answer_of_which_nothing_was_taken_for_longest_and_none_that_is_being_taken() {
        let slots = ConnectionSlots::new(8);
        let memory = AnswerMemory::new(1);
        let half = 512 << 10;
        let take = |bytes, seat: &Arc<ConnectionSlot>| memory.take(bytes, seat).0;
        let seat = async || slots.acquire(None).await.unwrap();
        let (a, b, c) = (seat().await, seat().await, seat().await);
        let mut first = take(half, &a).unwrap();
        let second = take(half, &b).unwrap();
        assert!(take(half, &c).is_none(), "both were begun a moment ago");
        age(&memory, 2 * STALLED_AFTER);
        first.taken();
        let third = take(half, &c).unwrap();
        b.close_requested().await;
        assert!(take(half, &c).is_none(), "all that is left is being taken");
        drop((second, third));
        assert!(take(half, &c).is_some());
        drop(first);
        assert_eq!(memory.lock().bytes, 0);
        assert!(take(5 << 20, &a).is_some(), "alone, an answer may be larger");
    }
}
