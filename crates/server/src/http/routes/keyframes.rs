//! Keyframes: stored with or without a loop query, read, corrected, deleted, and their poses in other tools' formats.

use axum::Json;
use axum::extract::State;
use axum::http::header::CONTENT_TYPE;
use axum::response::{IntoResponse as _, Response};
use tokio::task::spawn_blocking;

use super::loops::kept_answer;
use crate::api::anchor::LocalAnchorMap;
use crate::api::examples;
use crate::api::keyframe::{Keyframe, KeyframeAnswer, KeyframeView};
use crate::api::list::{CovisibleList, KeyframeList};
use crate::api::map::MapVersion;
use crate::api::observations::{ObservationsAnswer, ObservationsBody};
use crate::api::poses::{PosesAnswer, PosesBody};
use crate::api::trajectory::{MeasuredLoop, TrajectoryFormat, write_trajectory};
use crate::api::verdict::LoopAnswer;
use crate::domain::ids::MapId;
use crate::domain::key::Action;
use crate::domain::report::Page;
use crate::domain::request::{ChangedObservations, PoseCorrection};
use crate::domain::trajectory::TrajectoryReport;
use crate::engine::{Service, ServiceError};
use crate::http::answer::{Answer, written};
use crate::http::error_responses::{OfDelete, OfWrite, ReadErrors};
use crate::http::extract::answering::Answering;
use crate::http::extract::body::{Body, KeyframeInPath};
use crate::http::extract::path::{KeyframePath, MapPath};
use crate::http::extract::query::{KeyframeParams, KeyframeSearch, Paging, Query, TrajectoryQuery};
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
    State(service): State<Service>,
    caller: Caller,
    Query(also): Query<KeyframeParams>,
    KeyframeInPath { place: KeyframePath { map, .. }, keyframe, digest }: KeyframeInPath,
) -> Result<Response, Problem> {
    let detail = also.detail.unwrap_or_default().0;
    if also.query.is_none() {
        let stored = service.put_keyframe(&map, keyframe, digest).await?;
        return Ok(written(stored.created, KeyframeAnswer::from(stored.value)));
    }
    caller.needs(Action::Query)?;
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
) -> Answer<KeyframeList> {
    Ok(Json(service.list_keyframes(&map, search.redundant, page.into()).await?.into()))
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
) -> Answer<KeyframeView> {
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
) -> Answer<MapVersion> {
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
) -> Answer<CovisibleList> {
    let (version, items) = service.covisible(&map, &keyframe).await?;
    Ok(Json((version, Page { items, next_cursor: None }).into()))
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
) -> Answer<LocalAnchorMap> {
    let (map_version, anchors) = service.local_anchor_map(&map, &keyframe).await?;
    let anchors = anchors.into_iter().map(Into::into).collect();
    Ok(Json(LocalAnchorMap { keyframe: keyframe.to_string(), map_version, anchors }))
}

/// Correct poses and map points
///
/// For use after the client has closed a loop and optimised its map. All corrections are one transaction. Boxes of
/// anchors follow their points.
#[utoipa::path(
    post, path = "/v1/maps/{map}/poses", tag = "loops", params(MapPath), security(("key" = ["write"])),
    request_body(content = PosesBody, example = examples::poses_body),
    responses(
        (status = 200, description = "The corrections are stored", body = PosesAnswer, example = examples::poses_answer),
        OfWrite
    )
)]
pub async fn correct_poses(
    State(service): State<Service>,
    MapPath { map }: MapPath,
    Body(correction): Body<PoseCorrection>,
) -> Answer<PosesAnswer> {
    let (keyframes, map_points) = (correction.keyframes.len(), correction.map_points.len());
    let map_version = service.correct_poses(&map, correction).await?;
    Ok(Json(PosesAnswer { map_version, keyframes, map_points }))
}

/// Change what keyframes observe
///
/// For use when the robot's map has fused or culled map points, or found covisible keyframes, after the keyframes were sent.
/// All of it is one transaction. Covisibility, the map points and boxes of anchors, and association follow as if the
/// keyframes had been sent so, as far as `docs/method.md` (M57) says. Keyframes sent later name the points that stay. A retry of
/// a keyframe is compared with its body as first sent. Repeating the request changes nothing.
#[utoipa::path(
    post, path = "/v1/maps/{map}/observations", tag = "loops", params(MapPath), security(("key" = ["write"])),
    request_body(content = ObservationsBody, example = examples::observations_body),
    responses(
        (status = 200, description = "The changes are stored", body = ObservationsAnswer, example = examples::observations_answer),
        OfWrite
    )
)]
pub async fn change_observations(
    State(service): State<Service>,
    MapPath { map }: MapPath,
    Body(changed): Body<ChangedObservations>,
) -> Answer<ObservationsAnswer> {
    let (counts, map_version) = service.change_observations(&map, changed).await?;
    let (keyframes, map_points, anchors_merged) = (counts.keyframes, counts.map_points, counts.merged);
    Ok(Json(ObservationsAnswer { map_version, keyframes, map_points, anchors_merged }))
}

/// Read a trajectory
///
/// Poses (`map_from_camera`) as last corrected, by stamp. `tum`: lines of `seconds x y z qx qy qz qw`. `kitti`: lines
/// of twelve numbers, the upper rows of the pose. `g2o`: a pose graph of all sessions, each in its own frame, with
/// keyframes as vertices. `frame=fleet` puts all sessions that loops and plans join into one frame. Successive keyframes of a session are joined by their current relative pose. Confirmed loops
/// are joined by the transformation of their `query`, with the inverse of its `covariance` as information. A loop
/// whose query is no longer stored, or has no full transformation, is a comment. Information is in metres and radians,
/// as gtsam and Ceres read it.
#[utoipa::path(
    get, path = "/v1/maps/{map}/trajectory", tag = "keyframes", params(MapPath, TrajectoryQuery), security(("key" = ["read"])),
    responses(
        (status = 200, description = "The trajectory", body = String, content_type = "text/plain",
            example = "# timestamp tx ty tz qx qy qz qw\n1.000000000 0 0 0 0 0 0 1\n"),
        ReadErrors
    )
)]
pub async fn get_trajectory(
    Answering(service): Answering,
    MapPath { map }: MapPath,
    Query(asked): Query<TrajectoryQuery>,
) -> Result<Response, Problem> {
    let report = if asked.frame.unwrap_or(false) {
        service.trajectory_of_fleet(&map, asked.session, asked.reference).await?
    } else {
        service.trajectory(&map, asked.session).await?
    };
    let measured = match asked.format {
        TrajectoryFormat::G2o => measured(&service, &map, &report).await?,
        TrajectoryFormat::Tum | TrajectoryFormat::Kitti => Vec::new(),
    };
    // Formatting a hundred thousand poses takes long, so it must not block an async thread.
    let text = spawn_blocking(move || write_trajectory(&report, &measured, asked.format)).await;
    let text =
        text.map_err(|error| ServiceError::Internal(format!("a trajectory was not written: {error}")))?;
    let text = text.map_err(|fault| Problem::invalid(vec![fault]))?;
    Ok(([(CONTENT_TYPE, "text/plain; charset=utf-8")], text).into_response())
}

/// Returns the loops' transformations from the stored answers.
async fn measured(
    service: &Service,
    map: &MapId,
    report: &TrajectoryReport,
) -> Result<Vec<Option<MeasuredLoop>>, Problem> {
    let mut all = Vec::with_capacity(report.loops.len());
    for closed in &report.loops {
        let answer = kept_answer(service, map, closed.query.as_deref()).await?;
        all.push(answer.and_then(|answer| MeasuredLoop::of(&answer, closed.candidate_id.as_str())));
    }
    Ok(all)
}
