//! Anchors: search, put prior ones, read, describe by hand, delete.

use axum::Json;
use axum::extract::State;
use axum::http::header::{CONTENT_TYPE, ETAG, X_CONTENT_TYPE_OPTIONS};
use axum::response::{IntoResponse, Response};

use crate::api::anchor::{AnchorPatchBody, AnchorView};
use crate::api::examples;
use crate::api::list::AnchorList;
use crate::api::map::MapVersion;
use crate::api::prior::PriorBody;
use crate::api::transcript::TranscriptList;
use crate::engine::Service;
use crate::http::answer::{Answer, written};
use crate::http::error_responses::{OfPatch, OfVersionedDelete, OfWrite, ReadErrors};
use crate::http::extract::answering::Answering;
use crate::http::extract::body::Body;
use crate::http::extract::if_match::{IfMatch, etag};
use crate::http::extract::path::{AnchorPath, MapPath, PriorPath};
use crate::http::extract::query::{AnchorSearch, Paging, Query};
use crate::http::problem::Problem;

/// Search anchors
///
/// Oldest first, paged. Merged anchors are omitted unless requested.
#[utoipa::path(
    get, path = "/v1/maps/{map}/anchors", tag = "anchors", params(MapPath, AnchorSearch, Paging), security(("key" = ["read"])),
    responses((status = 200, description = "One page of the list", body = AnchorList, example = examples::anchors), ReadErrors)
)]
pub async fn list_anchors(
    Answering(service): Answering,
    MapPath { map }: MapPath,
    Query((filter, page)): Query<(AnchorSearch, Paging)>,
) -> Answer<AnchorList> {
    Ok(Json(service.list_anchors(&map, filter.into(), page.into()).await?.into()))
}

/// Read an anchor
///
/// Returns its readings, its position in each session's frame and the anchors that match it.
#[utoipa::path(
    get, path = "/v1/maps/{map}/anchors/{anchor}", tag = "anchors", params(AnchorPath), security(("key" = ["read"])),
    responses(
        (status = 200, description = "The anchor", body = AnchorView, 
            headers(("etag" = String, description = "The anchor's version, for `if-match`")), example = examples::anchor),
        ReadErrors
    )
)]
pub async fn get_anchor(
    Answering(service): Answering,
    AnchorPath { map, anchor }: AnchorPath,
) -> Result<Response, Problem> {
    let (version, report) = service.get_anchor(&map, anchor).await?;
    Ok(tagged(AnchorView::at(version, report)))
}

/// Put a prior anchor
///
/// A sign that a floor plan shows, known before any robot has seen it. It matches what robots read, aligns their sessions to
/// the plan, and closes no loop by itself. A plan's frame is a session that no robot drives.
#[utoipa::path(
    put, path = "/v1/maps/{map}/anchors/{anchor}", tag = "anchors", security(("key" = ["write"])), params(AnchorPath),
    request_body(content = PriorBody, example = examples::prior_body),
    responses(
        (status = 201, description = "The prior anchor is stored", body = AnchorView, example = examples::prior_anchor),
        (status = 200, description = "The same prior anchor was already stored", body = AnchorView,
            headers(("idempotent-replayed" = String, description = "`true`")), example = examples::prior_anchor),
        OfWrite
    )
)]
pub async fn put_prior_anchor(
    State(service): State<Service>,
    PriorPath { map, anchor: prior }: PriorPath,
    Body(fields): Body<PriorBody>,
) -> Result<Response, Problem> {
    let (version, stored) = service.put_prior(&map, fields.named(prior)).await?;
    Ok(written(stored.created, AnchorView::at(version, stored.value)))
}

/// Describe an anchor by hand
///
/// A manual description overrides later readings; null removes it. `if-match` states the version that the client has
/// seen.
#[utoipa::path(
    patch, path = "/v1/maps/{map}/anchors/{anchor}", tag = "anchors", security(("key" = ["write"])),
    params(AnchorPath, ("if-match" = String, Header, description = "The anchor's `etag`, or `*` for any version", example = "*")),
    request_body(content = AnchorPatchBody, example = examples::anchor_patch),
    responses(
        (status = 200, description = "The updated anchor", body = AnchorView, 
            headers(("etag" = String, description = "The anchor's version, for `if-match`")), example = examples::anchor),
        OfPatch
    )
)]
pub async fn patch_anchor(
    State(service): State<Service>,
    AnchorPath { map, anchor }: AnchorPath,
    seen: IfMatch,
    Body(patch): Body<AnchorPatchBody>,
) -> Result<Response, Problem> {
    let seen = seen.required()?;
    let (version, report) = service.describe_anchor(&map, anchor, seen, patch.description).await?;
    Ok(tagged(AnchorView::at(version, report)))
}

/// Delete an anchor
///
/// Its detections stay with their keyframes, but no longer belong to an anchor.
#[utoipa::path(
    delete, path = "/v1/maps/{map}/anchors/{anchor}", tag = "anchors", security(("key" = ["write"])),
    params(
        AnchorPath,
        ("if-match" = Option<String>, Header, description = "The anchor's `etag`; without it, any version",
            example = "\"4\"")
    ),
    responses(
        (status = 200, description = "The anchor is deleted", body = MapVersion, example = examples::map_version),
        OfVersionedDelete
    )
)]
pub async fn delete_anchor(
    State(service): State<Service>,
    AnchorPath { map, anchor }: AnchorPath,
    seen: IfMatch,
) -> Answer<MapVersion> {
    let map_version = service.delete_anchor(&map, anchor, seen.optional()).await?;
    Ok(Json(MapVersion { map_version }))
}

/// Read an anchor's best crop
///
/// The largest image of it in any detection, as it was sent.
#[utoipa::path(
    get, path = "/v1/maps/{map}/anchors/{anchor}/crop", tag = "anchors", params(AnchorPath), security(("key" = ["read"])),
    responses(
        (status = 200, description = "The image", content(
            (ImageFile = "image/png", example = "(the bytes of a PNG file)"),
            (ImageFile = "image/jpeg", example = "(the bytes of a JPEG file)")
        )),
        ReadErrors
    )
)]
pub async fn get_crop(
    Answering(service): Answering,
    AnchorPath { map, anchor }: AnchorPath,
) -> Result<Response, Problem> {
    let crop = service.crop(&map, anchor).await?;
    // Client content: browsers must not treat it as a page.
    Ok(([(CONTENT_TYPE, crop.media_type), (X_CONTENT_TYPE_OPTIONS, "nosniff")], crop.bytes).into_response())
}

/// Read how an anchor was described
///
/// The dialogues between a language model and a vision model about its crops, newest first; empty if no model has read
/// one.
#[utoipa::path(
    get, path = "/v1/maps/{map}/anchors/{anchor}/transcript", tag = "anchors", params(AnchorPath), security(("key" = ["read"])),
    responses((status = 200, description = "The dialogues", body = TranscriptList, example = examples::transcript), ReadErrors)
)]
pub async fn get_transcript(
    Answering(service): Answering,
    AnchorPath { map, anchor }: AnchorPath,
) -> Answer<TranscriptList> {
    let (version, transcripts) = service.transcripts(&map, anchor.clone()).await?;
    Ok(Json(TranscriptList::of(version, &anchor, transcripts)))
}

/// An image file, as bytes.
#[derive(utoipa::ToSchema)]
#[schema(value_type = String, format = Binary)]
#[expect(dead_code, reason = "a schema only")]
pub struct ImageFile(Vec<u8>);

fn tagged(anchor: AnchorView) -> Response {
    ([(ETAG, etag(anchor.version))], Json(anchor)).into_response()
}
