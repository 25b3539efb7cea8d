//! Keyframes: stored with or without a loop query, read, deleted.

use axum::Json;
use axum::extract::State;
use axum::response::Response;

use crate::api::anchor::LocalAnchorMap;
use crate::api::examples;
use crate::api::keyframe::{Keyframe, KeyframeAnswer, KeyframeView};
use crate::api::list::{CovisibleList, KeyframeList};
use crate::api::map::MapVersion;
use crate::api::verdict::LoopAnswer;
use crate::domain::key::Action;
use crate::domain::report::Page;
use crate::engine::Service;
use crate::http::App;
use crate::http::answer::written;
use crate::http::error_responses::{OfDelete, OfWrite, ReadErrors};
use crate::http::extract::answering::Answering;
use crate::http::extract::body::KeyframeInPath;
use crate::http::extract::path::{KeyframePath, MapPath};
use crate::http::extract::query::{KeyframeParams, KeyframeSearch, Paging, Query};
use crate::http::guards::access::Caller;
use crate::http::problem::Problem;

/// Store a keyframe
///
/// Its detections are associated with anchors. With `?query=loop` the response includes the answer of a loop query.
/// Sending the same keyframe again changes nothing and returns 200, also with its lists in another order or packed; a different one
/// under the same id is a conflict.
#[utoipa::path(
    put, path = "/v1/maps/{map}/keyframes/{keyframe}", tag = "keyframes", params(KeyframePath, KeyframeParams), security(("key" = ["write"])),
    request_body(content = Keyframe, example = examples::keyframe_body),
    responses(
        (status = 201, description = "The keyframe is stored", body = KeyframeAnswer, example = examples::keyframe_answer),
        (status = 200, description = "The same keyframe was already stored", body = KeyframeAnswer,
            headers(("idempotent-replayed" = String, description = "`true`")), example = examples::keyframe_answer),
        OfWrite
    )
)]
pub async fn put_keyframe(
    State(app): State<App>,
    caller: Caller,
    Query(also): Query<KeyframeParams>,
    KeyframeInPath { place: KeyframePath { map, .. }, keyframe, digest }: KeyframeInPath,
) -> Result<Response, Problem> {
    let asked = also.query.is_some();
    let detail = also.detail.unwrap_or_default().0;
    if asked {
        caller.needs(Action::Query)?;
    }
    let service = &app.service;
    if !asked {
        let stored = service.put_keyframe(&map, keyframe, digest).await?;
        return Ok(written(stored.created, KeyframeAnswer::from(stored.value)));
    }
    let (stored, answer) = service.put_keyframe_and_query(&map, keyframe, digest).await?;
    let view = LoopAnswer::of(&answer.id, answer.keyframe.as_ref(), &answer.verdict, detail);
    Ok(written(stored.created, KeyframeAnswer { loop_answer: Some(view), ..stored.value.into() }))
}

/// List keyframes
///
/// In order of arrival, paged.
///
/// With `redundant=true` only those that may be deleted when a quota nears: others see 90 % of their map points and every anchor.
/// Each is so in its turn, without those before it in the page, so that all of a page may be deleted; delete them before the
/// next page is asked for. A page looks at 1,000 keyframes at most, so it may be short or empty with a `next_cursor`. Nothing is
/// deleted unasked.
#[utoipa::path(
    get, path = "/v1/maps/{map}/keyframes", tag = "keyframes", params(MapPath, KeyframeSearch, Paging), security(("key" = ["read"])),
    responses(
        (status = 200, description = "One page of the list", body = KeyframeList, example = examples::keyframes),
        ReadErrors
    )
)]
pub async fn list_keyframes(
    Answering(service): Answering,
    MapPath { map }: MapPath,
    Query((search, page)): Query<(KeyframeSearch, Paging)>,
) -> Result<Json<KeyframeList>, Problem> {
    let (version, keyframes) = service.list_keyframes(&map, search.redundant, page.into()).await?;
    Ok(Json(KeyframeList::of(version, keyframes)))
}

/// Read a keyframe
///
/// As it was sent, with its last corrected pose and points, with what it observes now, and the anchors of its detections.
#[utoipa::path(
    get, path = "/v1/maps/{map}/keyframes/{keyframe}", tag = "keyframes", params(KeyframePath), security(("key" = ["read"])),
    responses((status = 200, description = "The keyframe", body = KeyframeView, example = examples::keyframe), ReadErrors)
)]
pub async fn get_keyframe(
    Answering(service): Answering,
    KeyframePath { map, keyframe }: KeyframePath,
) -> Result<Json<KeyframeView>, Problem> {
    let (version, record) = service.get_keyframe(&map, &keyframe).await?;
    Ok(Json(KeyframeView::of(version, record)))
}

/// Cull a keyframe
///
/// Deletes its observations, too, and any anchor without other observations.
#[utoipa::path(
    delete, path = "/v1/maps/{map}/keyframes/{keyframe}", tag = "keyframes", params(KeyframePath), security(("key" = ["write"])),
    responses(
        (status = 200, description = "The keyframe is deleted", body = MapVersion, example = examples::map_version),
        OfDelete
    )
)]
pub async fn delete_keyframe(
    State(service): State<Service>,
    KeyframePath { map, keyframe }: KeyframePath,
) -> Result<Json<MapVersion>, Problem> {
    let map_version = service.delete_keyframe(&map, &keyframe).await?;
    Ok(Json(MapVersion { map_version }))
}

/// List covisible keyframes
///
/// Keyframes that share enough map points with it, or that a client or a confirmed loop declared covisible.
#[utoipa::path(
    get, path = "/v1/maps/{map}/keyframes/{keyframe}/covisible", tag = "keyframes", params(KeyframePath), security(("key" = ["read"])),
    responses(
        (status = 200, description = "All covisible keyframes", body = CovisibleList, example = examples::covisible),
        ReadErrors
    )
)]
pub async fn list_covisible(
    Answering(service): Answering,
    KeyframePath { map, keyframe }: KeyframePath,
) -> Result<Json<CovisibleList>, Problem> {
    let (version, items) = service.covisible(&map, &keyframe).await?;
    Ok(Json(CovisibleList::of(version, Page { items, next_cursor: None })))
}

/// Read a local anchor map
///
/// M_k of §V-A: the anchors seen by a keyframe and its covisible keyframes, as bearings and distances from its camera.
#[utoipa::path(
    get, path = "/v1/maps/{map}/keyframes/{keyframe}/local-anchor-map", tag = "keyframes", params(KeyframePath), security(("key" = ["read"])),
    responses(
        (status = 200, description = "The local anchor map", body = LocalAnchorMap, example = examples::local_anchor_map),
        ReadErrors
    )
)]
pub async fn get_local_anchor_map(
    Answering(service): Answering,
    KeyframePath { map, keyframe }: KeyframePath,
) -> Result<Json<LocalAnchorMap>, Problem> {
    let (map_version, anchors) = service.local_anchor_map(&map, &keyframe).await?;
    let anchors = anchors.into_iter().map(Into::into).collect();
    Ok(Json(LocalAnchorMap { keyframe: keyframe.to_string(), map_version, anchors }))
}
