//! Sessions: the robots' runs and the plans' frames of a map, their merges, and one frame for all.

use axum::Json;
use axum::extract::State;

use crate::api::examples;
use crate::api::frames::FramesView;
use crate::api::list::SessionList;
use crate::api::session_merge::{MergeBody, MergeFields, MergeRevokedAnswer, SessionsMergedAnswer};
use crate::engine::Service;
use crate::http::answer::Answer;
use crate::http::error_responses::{OfRevocation, OfWrite, ReadErrors};
use crate::http::extract::answering::Answering;
use crate::http::extract::body::Body;
use crate::http::extract::path::{MapPath, SessionPath};
use crate::http::extract::query::{FramesQuery, Paging, Query};

/// List sessions
///
/// In order of appearance, paged. A session is aligned to a plan once two distinctive signs or more agree and no other place
/// explains them as well; the alignment is computed anew as more signs are read.
#[utoipa::path(
    get, path = "/v1/maps/{map}/sessions", tag = "maps", params(MapPath, Paging), security(("key" = ["read"])),
    responses((status = 200, description = "One page of the list", body = SessionList, example = examples::sessions), ReadErrors)
)]
pub async fn list_sessions(
    Answering(service): Answering,
    MapPath { map }: MapPath,
    Query(page): Query<Paging>,
) -> Answer<SessionList> {
    Ok(Json(service.list_sessions(&map, page.into()).await?.into()))
}

/// Merge a session into another one
///
/// For use when two maps of a robot became one, as ORB-SLAM3's Atlas merges them. Keyframes keep their ids; they, their map points
/// and anchors move into the frame of `into`, in one transaction. Covisibility and association follow (`docs/method.md`, M59).
/// Keyframes sent later name `into`; one that names the session still begins it anew, in its own frame. Can be revoked until
/// something is written in one of the two sessions.
#[utoipa::path(
    post, path = "/v1/maps/{map}/sessions/{session}/merge", tag = "loops", params(SessionPath), security(("key" = ["write"])),
    request_body(content = MergeBody, example = examples::merge_body),
    responses(
        (status = 200, description = "The sessions are one", body = SessionsMergedAnswer, example = examples::sessions_merged),
        OfWrite
    )
)]
pub async fn merge_sessions(
    State(service): State<Service>,
    SessionPath { map, session }: SessionPath,
    Body(merge): Body<MergeFields>,
) -> Answer<SessionsMergedAnswer> {
    let (counts, map_version) = service.merge_sessions(&map, merge.of(session)).await?;
    let (keyframes, map_points, anchors_merged) = (counts.keyframes, counts.map_points, counts.merged);
    Ok(Json(SessionsMergedAnswer { map_version, keyframes, map_points, anchors_merged }))
}

/// Revoke a merge of sessions
///
/// For a merge that was wrong: everything is as before it, to the bit. Not possible once a keyframe, pose, map point or
/// observation was written in one of the two sessions.
#[utoipa::path(
    delete, path = "/v1/maps/{map}/sessions/{session}/merge", tag = "loops", params(SessionPath), security(("key" = ["write"])),
    responses(
        (status = 200, description = "The sessions are two again", body = MergeRevokedAnswer, example = examples::merge_revoked),
        OfRevocation
    )
)]
pub async fn revoke_merge(
    State(service): State<Service>,
    SessionPath { map, session }: SessionPath,
) -> Answer<MergeRevokedAnswer> {
    let (keyframes, map_version) = service.revoke_merge(&map, session).await?;
    Ok(Json(MergeRevokedAnswer { map_version, keyframes }))
}

/// Put all sessions in one frame
///
/// Confirmed loops between sessions, verified by geometry, and alignments to plans say where the sessions lie to each other. Loops that
/// contradict the rest do not count, and are listed as suspects (event `loop_suspected`). Computed after a loop was confirmed or
/// revoked, and kept: the same version is the same to the byte. Loops without a transformation (the client sent none, and their query is
/// not named, was not verified by geometry, or was no longer stored) are left out and counted. In a map that is not metric each session stands alone.
#[utoipa::path(
    get, path = "/v1/maps/{map}/frames", tag = "maps", params(MapPath, FramesQuery), security(("key" = ["read"])),
    responses((status = 200, description = "The frames", body = FramesView, example = examples::frames), ReadErrors)
)]
pub async fn get_frames(
    State(service): State<Service>,
    MapPath { map }: MapPath,
    Query(asked): Query<FramesQuery>,
) -> Answer<FramesView> {
    Ok(Json(service.frames(&map, asked.reference).await?.into()))
}
