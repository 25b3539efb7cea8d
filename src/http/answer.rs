//! Answer: the few forms of a successful response.

use axum::Json;
use axum::http::header::CONTENT_TYPE;
use axum::http::{HeaderName, HeaderValue, StatusCode};
use axum::response::{IntoResponse, Response};
use bytes::Bytes;
use serde::Serialize;

const REPLAYED: HeaderName = HeaderName::from_static("idempotent-replayed");

/// Returns a write by id: 201 when it is new, 200 and `idempotent-replayed: true` when it was there already.
pub fn written(created: bool, body: impl Serialize) -> Response {
    if created {
        return (StatusCode::CREATED, Json(body)).into_response();
    }
    ([(REPLAYED, HeaderValue::from_static("true"))], Json(body)).into_response()
}

/// JSON that is written already.
pub fn json_bytes(bytes: Bytes) -> Response {
    ([(CONTENT_TYPE, HeaderValue::from_static("application/json"))], bytes).into_response()
}
