//! Trajectories: a map's poses in the formats of evo, g2o and gtsam.

use axum::http::header::CONTENT_TYPE;
use axum::response::{IntoResponse, Response};
use tokio::task::spawn_blocking;

use crate::api::trajectory::{MeasuredLoop, TrajectoryFormat, write_trajectory};
use crate::domain::ids::MapId;
use crate::domain::trajectory::TrajectoryReport;
use crate::engine::{Service, ServiceError};
use crate::http::error_responses::ReadErrors;
use crate::http::extract::answering::Answering;
use crate::http::extract::path::MapPath;
use crate::http::extract::query::Query;
use crate::http::extract::trajectory_query::TrajectoryQuery;
use crate::http::problem::Problem;

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
        let Some(query) = &closed.query else {
            all.push(None);
            continue;
        };
        all.push(match service.kept_query(map, query).await {
            Ok(answer) => MeasuredLoop::of(&answer, closed.candidate_id.as_str()),
            // The number of stored answers is limited, and a client may name a query of its own.
            Err(ServiceError::NotFound(_)) => None,
            Err(error) => return Err(error.into()),
        });
    }
    Ok(all)
}
