//! Body completion: a response body that reports when its last byte has been sent.

use std::pin::Pin;
use std::sync::Arc;
use std::task::Context;

use axum::body::{Body, Bytes, HttpBody};
use hyper::body::SizeHint;

use super::PolledFrame;
use super::connection_limit::ConnectionSlot;

/// The body of a response; when it is dropped, its connection waits for the next request.
pub struct CompletionBody {
    body: Body,
    seat: Arc<ConnectionSlot>,
}

impl CompletionBody {
    /// Returns the body of a response on the connection of this slot.
    pub fn new(body: Body, seat: Arc<ConnectionSlot>) -> Self {
        Self { body, seat }
    }
}

impl Drop for CompletionBody {
    fn drop(&mut self) {
        self.seat.rests();
    }
}

impl HttpBody for CompletionBody {
    type Data = Bytes;
    type Error = axum::Error;

    fn poll_frame(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> PolledFrame<axum::Error> {
        Pin::new(&mut self.body).poll_frame(cx)
    }

    fn is_end_stream(&self) -> bool {
        self.body.is_end_stream()
    }

    fn size_hint(&self) -> SizeHint {
        self.body.size_hint()
    }
}
