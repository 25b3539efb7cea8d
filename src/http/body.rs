//! Body: a request's bytes become what they mean, within bounds and off the async threads where they are many.

use std::error::Error;

use axum::RequestExt as _;
use axum::body::HttpBody as _;
use axum::extract::{FromRequest, Request};
use axum::http::HeaderMap;
use axum::http::header::{CONTENT_LENGTH, CONTENT_TYPE, EXPECT};
use bytes::{Bytes, BytesMut};
use http_body_util::{BodyExt as _, LengthLimitError};
use serde_json::Value;
use tower_http::timeout::TimeoutError;

use super::path::InKeyframe;
use super::problem::{Kind, Problem};
use crate::config::logging::in_span;
use crate::wire::keyframe::{self, SentKeyframe};
use crate::wire::limits;
use crate::wire::read::{self, Decode};
use crate::wire::syntax::{self, Unreadable};

/// Bodies up to this are decoded where they are: that takes less than a millisecond.
const SMALL_BODY_BYTES: usize = 64 << 10;
/// How much more than allowed is read and thrown away, so that the client gets to see the answer: a connection closed
/// on unread bytes is reset, and the answer with it.
const DISCARDED_BYTES: usize = 4 * limits::BODY_BYTES;

/// A JSON body, read into the model.
pub struct Body<T>(pub T);

impl<T: Decode + Send + 'static, S: Send + Sync> FromRequest<S> for Body<T> {
    type Rejection = Problem;

    async fn from_request(request: Request, _: &S) -> Result<Self, Problem> {
        let bytes = json_bytes(request).await?;
        decoded(bytes, |value| read::decode(&value).map_err(Problem::invalid)).await.map(Self)
    }
}

/// A keyframe in the body, named by the path.
pub struct KeyframeInPath {
    /// Where it is to be stored.
    pub place: InKeyframe,
    /// The keyframe.
    pub sent: SentKeyframe,
}

impl<S: Send + Sync> FromRequest<S> for KeyframeInPath {
    type Rejection = Problem;

    async fn from_request(mut request: Request, _: &S) -> Result<Self, Problem> {
        let place: InKeyframe = request.extract_parts().await?;
        let bytes = json_bytes(request).await?;
        let id = place.keyframe.clone();
        let sent =
            decoded(bytes, move |value| keyframe::named(&value, &id).map_err(Problem::invalid)).await?;
        Ok(Self { place, sent })
    }
}

/// Parses bytes and reads the value, on a thread where it may take its time if they are many.
pub async fn decoded<T: Send + 'static>(
    bytes: Bytes,
    read: impl FnOnce(Value) -> Result<T, Problem> + Send + 'static,
) -> Result<T, Problem> {
    let large = bytes.len() > SMALL_BODY_BYTES;
    let decode = move || parsed(&bytes).and_then(read);
    if !large {
        return decode();
    }
    tokio::task::spawn_blocking(in_span(decode))
        .await
        .unwrap_or_else(|error| Err(Problem::internal(error.to_string())))
}

fn parsed(bytes: &[u8]) -> Result<Value, Problem> {
    syntax::parse(bytes).map_err(|error| match error {
        Unreadable::Syntax(fault) => Problem::new(Kind::SYNTAX, fault.detail.clone()).with(vec![fault]),
        Unreadable::TooManyValues => {
            Problem::new(Kind::TOO_LARGE, format!("the body holds more than {} values", limits::BODY_VALUES))
        }
    })
}

/// Refuses a body whose type is none of these; a body that does not say is taken at its word.
pub fn expect_type(
    headers: &HeaderMap,
    accepted: impl Fn(&str) -> bool,
    wanted: &str,
) -> Result<(), Problem> {
    let Some(given) = headers.get(CONTENT_TYPE) else { return Ok(()) };
    let given = given.to_str().unwrap_or_default();
    let essence = given.split(';').next().unwrap_or_default().trim().to_ascii_lowercase();
    if accepted(&essence) {
        return Ok(());
    }
    // What curl sends unless told otherwise; taken for JSON it would let any web page write here unasked.
    let hint = if essence == "application/x-www-form-urlencoded" {
        format!("; with curl, add -H 'content-type: {wanted}'")
    } else {
        String::new()
    };
    Err(Problem::new(
        Kind::UNSUPPORTED_MEDIA_TYPE,
        format!("the content-type is {essence:?}, not {wanted}{hint}"),
    ))
}

async fn json_bytes(request: Request) -> Result<Bytes, Problem> {
    let is_json = |essence: &str| essence == "application/json" || essence.ends_with("+json");
    expect_type(request.headers(), is_json, "application/json")?;
    // Who asks before sending gets the answer before sending.
    if request.headers().contains_key(EXPECT) && announced(request.headers()) > limits::BODY_BYTES {
        return Err(too_large());
    }
    let mut body = request.into_body();
    let mut bytes = BytesMut::with_capacity(body.size_hint().lower().min(limits::BODY_BYTES as u64) as usize);
    let mut discarded = 0;
    while let Some(frame) = body.frame().await {
        let Ok(data) = frame.map_err(|error| unreadable(&error))?.into_data() else { continue };
        if discarded == 0 && bytes.len() + data.len() <= limits::BODY_BYTES {
            bytes.extend_from_slice(&data);
            continue;
        }
        bytes = BytesMut::new();
        discarded += data.len();
        if discarded > DISCARDED_BYTES {
            break;
        }
    }
    if discarded > 0 { Err(too_large()) } else { Ok(bytes.freeze()) }
}

fn announced(headers: &HeaderMap) -> usize {
    headers.get(CONTENT_LENGTH).and_then(|value| value.to_str().ok()?.parse().ok()).unwrap_or(0)
}

fn too_large() -> Problem {
    Problem::new(
        Kind::TOO_LARGE,
        format!("a body has at most {} bytes, compressed or not", limits::BODY_BYTES),
    )
}

/// Why a body broke off: the layers below hide it in a chain of errors.
pub fn unreadable(error: &axum::Error) -> Problem {
    let mut cause: Option<&(dyn Error + 'static)> = Some(error);
    while let Some(error) = cause {
        if error.is::<LengthLimitError>() {
            return too_large();
        }
        if error.is::<TimeoutError>() {
            return Problem::new(Kind::TIMEOUT, "no more of the body arrived for a while");
        }
        cause = error.source();
    }
    let detail = "the body broke off, or is not compressed as its content-encoding says";
    Problem::new(Kind::BAD_REQUEST, detail)
}
