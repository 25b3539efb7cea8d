//! Observations: what the client's map did to points and edges after it had sent the keyframes.

use axum::Json;
use axum::extract::State;

use crate::api::examples;
use crate::api::observations::{ObservationsAnswer, ObservationsBody};
use crate::domain::request::ChangedObservations;
use crate::engine::Service;
use crate::http::error_responses::OfWrite;
use crate::http::extract::body::Body;
use crate::http::extract::path::MapPath;
use crate::http::problem::Problem;

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
) -> Result<Json<ObservationsAnswer>, Problem> {
    let (counts, map_version) = service.change_observations(&map, changed).await?;
    Ok(Json(ObservationsAnswer {
        map_version,
        keyframes: counts.keyframes,
        map_points: counts.map_points,
        anchors_merged: counts.merged,
    }))
}
