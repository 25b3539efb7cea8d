//! Poses: what the client's optimisation corrected.

use axum::Json;
use axum::extract::State;

use crate::http::body::Body;
use crate::http::path::{InMap, MapPath};
use crate::http::problem::Problem;
use crate::http::refusals::OfWrite;
use crate::model::request::PoseCorrection;
use crate::service::Service;
use crate::wire::examples;
use crate::wire::poses::{PosesAnswer, PosesBody};

/// Correct poses and map points
///
/// After a loop was closed and the client has optimised: all of it in one transaction, or nothing. Boxes of anchors
/// follow their points.
#[utoipa::path(
    post, path = "/v1/maps/{map}/poses", tag = "loops", params(MapPath), security(("key" = ["write"])),
    request_body(content = PosesBody, example = examples::poses_body),
    responses(
        (status = 200, description = "They are corrected", body = PosesAnswer, example = examples::poses_answer),
        OfWrite
    )
)]
pub async fn correct_poses(
    State(service): State<Service>,
    InMap(map): InMap,
    Body(correction): Body<PoseCorrection>,
) -> Result<Json<PosesAnswer>, Problem> {
    let (keyframes, map_points) = (correction.keyframes.len(), correction.map_points.len());
    let map_version = service.correct_poses(&map, correction).await?;
    Ok(Json(PosesAnswer { map_version, keyframes, map_points }))
}
