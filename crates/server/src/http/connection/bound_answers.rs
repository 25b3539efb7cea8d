//! The layer that counts large responses, and sends them in pieces ([`AnswerMemory`]).
//!
//! [`AnswerMemory`]: super::answer_memory::AnswerMemory

use std::pin::Pin;
use std::sync::Arc;
use std::task::{Context, Poll, ready};

use axum::body::{Body, Bytes, HttpBody};
use axum::extract::{Request, State};
use axum::middleware::Next;
use axum::response::{IntoResponse as _, Response};
use hyper::body::{Frame, SizeHint};

use super::PolledFrame;
use super::answer_memory::Share;
use super::connection_limit::ConnectionSlot;
use crate::http::App;
use crate::http::problem::Problem;

/// Responses up to this size are not counted: the connection limit bounds their number.
const UNCOUNTED_BYTES: u64 = 64 << 10;
/// Size of the pieces of a large response, which show whether its client is reading.
const PIECE_BYTES: usize = 64 << 10;

/// Middleware that counts large responses, and rejects those for which there is no memory.
pub async fn bound_answers(State(app): State<App>, request: Request, next: Next) -> Response {
    let slot = request.extensions().get::<Arc<ConnectionSlot>>().cloned();
    let response = next.run(request).await;
    // An event stream has no length, and holds one event at a time.
    let length = response.body().size_hint().exact().filter(|length| *length > UNCOUNTED_BYTES);
    let (Some(slot), Some(length)) = (slot, length) else { return response };
    let (share, evictions) = app.answers.take(length as usize, &slot);
    (0..evictions).for_each(|_| app.metrics.connection("evicted"));
    let Some(share) = share else {
        app.metrics.shed("answer");
        let detail = "responses not yet received by other clients use all of the memory for responses";
        return Problem::overloaded(detail).into_response();
    };
    response.map(|body| Body::new(Pieces { body, rest: Bytes::new(), share }))
}

/// A body that is sent in pieces.
struct Pieces {
    body: Body,
    rest: Bytes,
    share: Share,
}

impl HttpBody for Pieces {
    type Data = Bytes;
    type Error = axum::Error;

    fn poll_frame(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> PolledFrame<axum::Error> {
        // The next piece is requested once the previous one has been sent.
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
