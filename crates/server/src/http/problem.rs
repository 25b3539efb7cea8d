//! Problem: the reason why a request was rejected or failed, before the envelope writes it (`openapi/openapi.yaml`).

use std::time::Duration;

use axum::http::header::{RETRY_AFTER, WWW_AUTHENTICATE};
use axum::http::{HeaderValue, StatusCode};
use axum::response::{IntoResponse, Response};

use crate::api::problem::{FaultView, ProblemView};
use crate::domain::invalid::FieldError;
use crate::engine::ServiceError;

/// A kind of problem: its status, code and title, which `/docs` explains.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Kind {
    /// The HTTP status.
    pub status: StatusCode,
    /// The code for programs.
    pub code: &'static str,
    /// The title for people.
    pub title: &'static str,
}

macro_rules! kinds {
    ($($name:ident = $status:ident, $code:literal, $title:literal;)*) => {
        impl Kind {
            $(#[doc = $title] pub const $name: Self =
                Self { status: StatusCode::$status, code: $code, title: $title };)*

            /// Every kind, by status.
            pub const ALL: &'static [Self] = &[$(Self::$name),*];
        }
    };
}

kinds! {
    SYNTAX = BAD_REQUEST, "syntax", "The body is not valid JSON";
    BAD_REQUEST = BAD_REQUEST, "bad_request", "The request is malformed";
    UNAUTHORIZED = UNAUTHORIZED, "unauthorized", "An API key is required";
    FORBIDDEN = FORBIDDEN, "forbidden", "The API key does not permit this operation";
    NOT_FOUND = NOT_FOUND, "not_found", "The resource does not exist";
    METHOD_NOT_ALLOWED = METHOD_NOT_ALLOWED, "method_not_allowed", "The method is not allowed for this path";
    TIMEOUT = REQUEST_TIMEOUT, "timeout", "The body took too long to arrive";
    CONFLICT = CONFLICT, "conflict", "The request conflicts with stored data";
    GONE = GONE, "gone", "The requested events are no longer available";
    PRECONDITION_FAILED = PRECONDITION_FAILED, "precondition_failed", "The resource has changed since it was read";
    TOO_LARGE = PAYLOAD_TOO_LARGE, "too_large", "The request is too large";
    UNSUPPORTED_MEDIA_TYPE = UNSUPPORTED_MEDIA_TYPE, "unsupported_media_type", "The body's media type or encoding is not supported";
    INVALID = UNPROCESSABLE_ENTITY, "invalid", "The request is invalid";
    PRECONDITION_REQUIRED = PRECONDITION_REQUIRED, "precondition_required", "The if-match header is required";
    TOO_MANY_REQUESTS = TOO_MANY_REQUESTS, "too_many_requests", "A limit of the API key is exceeded";
    INTERNAL = INTERNAL_SERVER_ERROR, "internal", "Internal server error";
    MAP_DAMAGED = INTERNAL_SERVER_ERROR, "map_damaged", "The map is damaged on disk";
    NOT_VERIFIED = INTERNAL_SERVER_ERROR, "backup_not_verified", "The backup failed verification";
    UNAVAILABLE = SERVICE_UNAVAILABLE, "unavailable", "The server is temporarily unavailable";
    DISK_FULL = INSUFFICIENT_STORAGE, "disk_full", "The disk is full";
    MAP_FULL = INSUFFICIENT_STORAGE, "map_full", "The map is full";
}

/// The code of requests rejected under overload.
const OVERLOADED: &str = "overloaded";

/// One problem. As a response it has only its status: the envelope, which knows the request's id, writes the body.
#[derive(Clone, Debug)]
pub struct Problem {
    kind: Kind,
    code: &'static str,
    detail: Box<str>,
    errors: Vec<FieldError>,
    retry_after_s: Option<u32>,
    cause: Option<Box<str>>,
}

impl Problem {
    /// Creates a problem of a kind, with the detail of this occurrence.
    pub fn new(kind: Kind, detail: impl Into<String>) -> Self {
        let detail = detail.into().into();
        // Every 503 states when to retry.
        let retry_after_s = (kind == Kind::UNAVAILABLE).then_some(1);
        Self { kind, code: kind.code, detail, errors: Vec::new(), retry_after_s, cause: None }
    }

    /// Creates the problem of a bare status, as lower layers return it.
    pub fn of_status(status: StatusCode) -> Self {
        let reason = status.canonical_reason().unwrap_or("The request failed");
        let unnamed = Kind { status, code: "http", title: reason };
        let kind = Kind::ALL.iter().copied().find(|kind| kind.status == status && *kind != Kind::SYNTAX);
        let detail = match status {
            // A rejected content-type has its own problem, so this one is the encoding.
            StatusCode::UNSUPPORTED_MEDIA_TYPE => {
                "the content-encoding is not one of gzip, zstd and identity"
            }
            _ => reason,
        };
        Self::new(kind.unwrap_or(unnamed), detail)
    }

    /// Creates the problem of faults in the request's body, path or parameters.
    pub fn invalid(errors: Vec<FieldError>) -> Self {
        let detail = match errors.as_slice() {
            [one] => {
                // The pointer of a header ends in a colon.
                let at = one.pointer.trim_end_matches(':');
                format!("{}: {}", if at.is_empty() { "the body" } else { at }, one.detail)
            }
            several => format!("{} faults, each listed", several.len()),
        };
        Self { errors, ..Self::new(Kind::INVALID, detail) }
    }

    /// Creates the problem of a key that exceeds its rate, with the time until it may retry.
    pub fn too_many_requests(wait: Duration) -> Self {
        let seconds = wait.as_secs_f64().ceil().clamp(1.0, f64::from(u32::MAX)) as u32;
        Self {
            retry_after_s: Some(seconds),
            ..Self::had_its_share("the key exceeds its requests per second")
        }
    }

    /// Creates the problem of a key that has reached a concurrency limit.
    pub fn had_its_share(detail: impl Into<String>) -> Self {
        Self { retry_after_s: Some(1), ..Self::new(Kind::TOO_MANY_REQUESTS, detail) }
    }

    /// Creates an internal error; `cause` is only logged.
    pub fn internal(cause: impl Into<String>) -> Self {
        let detail = "the server's log has the cause under the request's id";
        Self { cause: Some(cause.into().into()), ..Self::new(Kind::INTERNAL, detail) }
    }

    /// Creates an internal error that the client can act on: returned and logged.
    fn logged(kind: Kind, detail: String) -> Self {
        Self { cause: Some(detail.as_str().into()), ..Self::new(kind, detail) }
    }

    /// Creates the problem of a request rejected under overload, to be retried.
    pub fn overloaded(detail: impl Into<String>) -> Self {
        Self { code: OVERLOADED, ..Self::new(Kind::UNAVAILABLE, detail) }
    }

    /// Whether it was rejected only because of overload. Such rejections are counted, not logged, because they are
    /// frequent.
    pub fn is_overload(&self) -> bool {
        self.code == OVERLOADED
    }

    /// Returns the code.
    pub fn code(&self) -> &'static str {
        self.code
    }

    /// Returns the problem with these faults.
    pub fn with(self, errors: Vec<FieldError>) -> Self {
        Self { errors, ..self }
    }

    /// Returns the internal cause, for the log.
    pub fn cause(&self) -> Option<&str> {
        self.cause.as_deref()
    }

    /// Returns the problem document.
    pub fn view(self, request_id: &str) -> ProblemView {
        ProblemView {
            kind: format!("/docs#problem-{}", self.kind.code),
            title: self.kind.title.to_owned(),
            status: self.kind.status.as_u16(),
            detail: self.detail.into(),
            code: self.code.to_owned(),
            request_id: request_id.to_owned(),
            errors: self.errors.into_iter().map(FaultView::from).collect(),
        }
    }
}

impl From<ServiceError> for Problem {
    fn from(error: ServiceError) -> Self {
        match error {
            ServiceError::NotFound(detail) => Self::new(Kind::NOT_FOUND, detail),
            ServiceError::Conflict { code, detail } => Self { code, ..Self::new(Kind::CONFLICT, detail) },
            ServiceError::Gone(detail) => Self::new(Kind::GONE, detail),
            ServiceError::PreconditionFailed(detail) => Self::new(Kind::PRECONDITION_FAILED, detail),
            ServiceError::Invalid(errors) => Self::invalid(errors),
            ServiceError::TooLarge(detail) => Self::new(Kind::TOO_LARGE, detail),
            ServiceError::DiskFull => Self::new(Kind::DISK_FULL, "writes fail; reads and deletes still work"),
            ServiceError::MapFull(detail) => Self::new(Kind::MAP_FULL, detail),
            ServiceError::Unavailable { detail, retry_after_s } => {
                Self { retry_after_s: Some(retry_after_s), ..Self::new(Kind::UNAVAILABLE, detail) }
            }
            ServiceError::Overloaded(detail) => Self::overloaded(detail),
            ServiceError::Damaged(detail) => Self::logged(Kind::MAP_DAMAGED, detail),
            ServiceError::NotVerified(detail) => Self::logged(Kind::NOT_VERIFIED, detail),
            ServiceError::Internal(cause) => Self::internal(cause),
        }
    }
}

impl IntoResponse for Problem {
    fn into_response(self) -> Response {
        let mut response = self.kind.status.into_response();
        if let Some(seconds) = self.retry_after_s {
            response.headers_mut().insert(RETRY_AFTER, seconds.into());
        }
        if self.kind == Kind::UNAUTHORIZED {
            response.headers_mut().insert(WWW_AUTHENTICATE, HeaderValue::from_static("Bearer"));
        }
        response.extensions_mut().insert(self);
        response
    }
}
