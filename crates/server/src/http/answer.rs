//! Answer: the forms of a successful response.

use axum::Json;
use axum::http::header::CONTENT_TYPE;
use axum::http::{HeaderName, HeaderValue, StatusCode};
use axum::response::{IntoResponse, Response};
use bytes::Bytes;
use serde::Serialize;

use super::problem::Problem;

/// A response of JSON, or the reason why there is none.
pub type Answer<T> = Result<Json<T>, Problem>;

const REPLAYED: HeaderName = HeaderName::from_static("idempotent-replayed");

/// Responds to a write by id: 201 if it is new, 200 and `idempotent-replayed: true` if it already existed.
pub fn written(created: bool, body: impl Serialize) -> Response {
    if created {
        return (StatusCode::CREATED, Json(body)).into_response();
    }
    ([(REPLAYED, HeaderValue::from_static("true"))], Json(body)).into_response()
}

/// Responds with JSON that is already serialised.
pub fn json_bytes(bytes: Bytes) -> Response {
    ([(CONTENT_TYPE, HeaderValue::from_static("application/json"))], bytes).into_response()
}
