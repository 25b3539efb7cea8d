//! Poses: corrections by the client's optimisation.

use axum::Json;
use axum::extract::State;

use crate::api::examples;
use crate::api::poses::{PosesAnswer, PosesBody};
use crate::domain::request::PoseCorrection;
use crate::engine::Service;
use crate::http::error_responses::OfWrite;
use crate::http::extract::body::Body;
use crate::http::extract::path::MapPath;
use crate::http::problem::Problem;

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
) -> Result<Json<PosesAnswer>, Problem> {
    let (keyframes, map_points) = (correction.keyframes.len(), correction.map_points.len());
    let map_version = service.correct_poses(&map, correction).await?;
    Ok(Json(PosesAnswer { map_version, keyframes, map_points }))
}
