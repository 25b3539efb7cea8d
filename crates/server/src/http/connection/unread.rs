//! Unread bodies: a request body that its handler did not read to the end.
//!
//! The next request of a connection begins where the previous body ends. A response that leaves part of a body unread
//! therefore either waits for the rest, or has `connection: close`. hyper closes such a connection, too, but decides
//! that only after the head is sent. The client would notice only when its next request fails.

use std::pin::Pin;
use std::sync::{Arc, Mutex};
use std::task::{Context, Poll};
use std::time::Duration;

use axum::body::{Body, Bytes, HttpBody};
use axum::http::header::{CONNECTION, EXPECT};
use axum::http::{HeaderValue, Request, Response, StatusCode};
use http_body_util::BodyExt as _;
use hyper::body::SizeHint;

use super::PolledFrame;
use crate::engine::lock::lock;

/// Maximum bytes of a body read after its request was answered; if more follow, the connection is closed.
const READ_BYTES: u64 = 64 << 10;
/// Maximum time that a response waits for the rest of its request's body.
const READ_FOR: Duration = Duration::from_secs(1);

/// The unread rest of a body after its request was answered.
pub struct Unread {
    left: Arc<Mutex<Left>>,
    /// Whether the client sends its body only after `100 Continue`.
    asks_first: bool,
}

enum Left {
    /// The body is in use.
    Lent,
    /// The body was read to its end.
    Nothing,
    /// The body failed.
    Broken,
    /// The body was dropped before its end; `begun` if some of it was read.
    Some { body: Body, begun: bool },
}

/// A body that is returned when it is dropped before its end.
struct Lent {
    body: Body,
    begun: bool,
    left: Arc<Mutex<Left>>,
}

impl Unread {
    /// Watches the body of a request.
    pub fn of(request: Request<Body>) -> (Request<Body>, Self) {
        let asks_first = request.headers().contains_key(EXPECT);
        let left = Arc::new(Mutex::new(Left::Lent));
        let lent = left.clone();
        let request = request.map(|body| Body::new(Lent { body, begun: false, left: lent }));
        (request, Self { left, asks_first })
    }

    /// Reads the rest of the body if it is small, or sets `connection: close`.
    pub async fn settle<B>(self, mut response: Response<B>) -> Response<B> {
        let left = std::mem::replace(&mut *lock(&self.left), Left::Nothing);
        let is_read = match left {
            Left::Nothing => true,
            Left::Lent | Left::Broken => false,
            // The client waits for `100 Continue`, and may never send.
            Left::Some { begun: false, .. } if self.asks_first => false,
            // It has already timed out.
            Left::Some { .. } if response.status() == StatusCode::REQUEST_TIMEOUT => false,
            Left::Some { body, .. } => read_rest(body).await,
        };
        if !is_read {
            response.headers_mut().insert(CONNECTION, HeaderValue::from_static("close"));
        }
        response
    }
}

/// Reads a body to its end, unless that takes too much or too long.
async fn read_rest(mut body: Body) -> bool {
    if body.size_hint().lower() > READ_BYTES {
        return false;
    }
    let reading = async {
        let mut read = 0;
        while let Some(frame) = body.frame().await {
            let Ok(frame) = frame else { return false };
            read += frame.data_ref().map_or(0, |data| data.len() as u64);
            if read > READ_BYTES {
                return false;
            }
        }
        true
    };
    tokio::time::timeout(READ_FOR, reading).await.unwrap_or(false)
}

impl Lent {
    fn becomes(&self, left: Left) {
        *lock(&self.left) = left;
    }
}

impl Drop for Lent {
    fn drop(&mut self) {
        if self.body.is_end_stream() {
            return self.becomes(Left::Nothing);
        }
        let mut left = lock(&self.left);
        if matches!(*left, Left::Lent) {
            *left = Left::Some { body: std::mem::take(&mut self.body), begun: self.begun };
        }
    }
}

impl HttpBody for Lent {
    type Data = Bytes;
    type Error = axum::Error;

    fn poll_frame(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> PolledFrame<axum::Error> {
        self.begun = true;
        let polled = Pin::new(&mut self.body).poll_frame(cx);
        match &polled {
            Poll::Ready(None) => self.becomes(Left::Nothing),
            Poll::Ready(Some(Err(_))) => self.becomes(Left::Broken),
            Poll::Ready(Some(Ok(_))) | Poll::Pending => {}
        }
        polled
    }

    fn is_end_stream(&self) -> bool {
        self.body.is_end_stream()
    }

    fn size_hint(&self) -> SizeHint {
        self.body.size_hint()
    }
}
