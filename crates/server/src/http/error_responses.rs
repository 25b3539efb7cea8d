//! Error responses of operations for the API document: each names a set of kinds.

use std::collections::BTreeMap;

use serde_json::json;
use utoipa::IntoResponses;
use utoipa::openapi::content::ContentBuilder;
use utoipa::openapi::{Ref, RefOr, Response, ResponseBuilder};

use super::problem::{Kind, Problem};
use crate::domain::invalid::FieldError;
use crate::engine::ServiceError;

macro_rules! refusals {
    ($($(#[$doc:meta])* $name:ident = [$($kind:ident),*];)*) => {
        $(
            $(#[$doc])*
            pub struct $name;

            impl IntoResponses for $name {
                fn responses() -> BTreeMap<String, RefOr<Response>> {
                    responses(&[$(Kind::$kind),*])
                }
            }
        )*
    };
}

refusals! {
    /// Of operations that only read a resource.
    ReadErrors = [BAD_REQUEST, NOT_FOUND, INVALID, MAP_DAMAGED, UNAVAILABLE];
    /// Of the event stream of a map.
    OfStream = [BAD_REQUEST, NOT_FOUND, GONE, INVALID, MAP_DAMAGED, UNAVAILABLE];
    /// Of operations that only read, without a named resource.
    OfList = [BAD_REQUEST, INVALID, UNAVAILABLE];
    /// Of queries with a body, without a named resource.
    OfQuestion = [SYNTAX, TIMEOUT, TOO_LARGE, UNSUPPORTED_MEDIA_TYPE, INVALID, UNAVAILABLE];
    /// Of queries about a map, with a body.
    OfMapQuestion = [SYNTAX, NOT_FOUND, TIMEOUT, TOO_LARGE, UNSUPPORTED_MEDIA_TYPE, INVALID, MAP_DAMAGED, UNAVAILABLE];
    /// Of operations that write a body.
    OfWrite = [
        SYNTAX, NOT_FOUND, TIMEOUT, CONFLICT, TOO_LARGE, UNSUPPORTED_MEDIA_TYPE, INVALID, MAP_DAMAGED, UNAVAILABLE,
        DISK_FULL
    ];
    /// Of the operation that creates a backup.
    OfBackup = [
        SYNTAX, TIMEOUT, CONFLICT, TOO_LARGE, UNSUPPORTED_MEDIA_TYPE, INVALID, NOT_VERIFIED, UNAVAILABLE, DISK_FULL
    ];
    /// Of operations that update a given version.
    OfPatch = [
        SYNTAX, NOT_FOUND, TIMEOUT, PRECONDITION_FAILED, TOO_LARGE, UNSUPPORTED_MEDIA_TYPE, INVALID,
        PRECONDITION_REQUIRED, UNAVAILABLE, DISK_FULL
    ];
    /// Of operations that delete.
    OfDelete = [BAD_REQUEST, NOT_FOUND, INVALID, UNAVAILABLE];
    /// Of operations that revoke what others may rest on: a key, a merge of sessions.
    OfRevocation = [BAD_REQUEST, NOT_FOUND, CONFLICT, INVALID, UNAVAILABLE];
    /// Of operations that delete a given version.
    OfVersionedDelete = [BAD_REQUEST, NOT_FOUND, PRECONDITION_FAILED, INVALID, UNAVAILABLE];
    /// Of the question about the asking key.
    OfKey = [NOT_FOUND, UNAVAILABLE];
    /// Of the readiness check.
    OfReadiness = [UNAVAILABLE];
    /// Of operations without errors of their own.
    OfNobody = [];
}

/// Returns the errors of every operation that requires a key.
pub fn of_keys() -> impl Iterator<Item = (String, RefOr<Response>)> {
    [Kind::UNAUTHORIZED, Kind::FORBIDDEN, Kind::TOO_MANY_REQUESTS]
        .into_iter()
        .map(|kind| (kind.status.as_str().to_owned(), reference(kind.code)))
}

/// Returns references: the document defines each kind once.
fn responses(kinds: &[Kind]) -> BTreeMap<String, RefOr<Response>> {
    let named = kinds.iter().map(|kind| (kind.status.as_str().to_owned(), reference(kind.code)));
    // Possible for any operation: an internal error, a proxy's limit, a header that is too long.
    named.chain([("default".to_owned(), reference(ANY))]).collect()
}

fn reference(code: &str) -> RefOr<Response> {
    Ref::from_response_name(code).into()
}

/// The name of the response for all other errors.
const ANY: &str = "other";

/// Returns every kind of error by its code, for the document's components.
pub fn components() -> impl Iterator<Item = (String, RefOr<Response>)> {
    let kinds = Kind::ALL.iter().map(|kind| (kind.code.to_owned(), response(*kind, kind.title)));
    kinds.chain([(ANY.to_owned(), response(Kind::INTERNAL, "Any other error"))])
}

fn response(kind: Kind, description: &str) -> RefOr<Response> {
    let content = ContentBuilder::new()
        .schema(Some(Ref::from_schema_name("Problem")))
        .example(Some(json!(example(kind).view("6c0f2a9e51d34b77-1f"))))
        .build();
    ResponseBuilder::new()
        .description(description)
        .content("application/problem+json", content)
        .build()
        .into()
}

/// Returns an example of this kind.
fn example(kind: Kind) -> Problem {
    let fault = |pointer: &str, detail: &str| FieldError::new(pointer, detail);
    match kind {
        Kind::SYNTAX => {
            let detail = "expected value at line 1 column 17";
            Problem::new(kind, detail).with(vec![fault("/stamp/sec", detail)])
        }
        Kind::INVALID => Problem::invalid(vec![
            fault("/pose/rotation", "not a unit quaternion: its norm is 0")
                .got("a norm of 0")
                .limit("a norm of 1, within 1 %"),
            fault("/stamp", "the field is required"),
        ]),
        Kind::NOT_FOUND => ServiceError::no_map("tower").into(),
        Kind::CONFLICT => Problem::new(kind, "keyframe kf-120 was stored with another body"),
        Kind::PRECONDITION_FAILED => Problem::new(kind, "the anchor's version is 5"),
        Kind::INTERNAL => Problem::internal(""),
        kind => Problem::new(kind, kind.title),
    }
}
