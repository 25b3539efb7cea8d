//! Judgements: jobs that re-evaluate verdicts with a changed model.

use axum::Json;
use axum::extract::State;
use axum::response::{IntoResponse as _, Response};

use crate::api::examples;
use crate::api::judgement::{JudgementBody, JudgementView};
use crate::domain::request::NewJudgement;
use crate::engine::Service;
use crate::http::answer::written;
use crate::http::error_responses::{OfDelete, OfWrite, ReadErrors};
use crate::http::extract::body::Body;
use crate::http::extract::path::{JudgementPath, MapPath};
use crate::http::problem::Problem;

/// Re-evaluate verdicts with a changed model
///
/// When a model or its prompts change, a map keeps its verdicts until this job re-evaluates them. With `"preview":
/// true` it only returns the number of questions and their maximum cost. The job runs in the background within the
/// budget and survives restarts; a map has one running job at a time. Replaced verdicts stay on record, and merged
/// anchors stay merged.
#[utoipa::path(
    post, path = "/v1/maps/{map}/judgements", tag = "anchors", params(MapPath), security(("key" = ["write"])),
    request_body(content = JudgementBody, example = examples::judgement_body),
    responses(
        (status = 201, description = "The job was started", body = JudgementView, example = examples::judgement),
        (status = 200, description = "A preview, or the existing job of this id", body = JudgementView,
            headers(("idempotent-replayed" = String, description = "`true`, unless it is a preview")),
            example = examples::judgement_preview),
        OfWrite
    )
)]
pub async fn judge_again(
    State(service): State<Service>,
    MapPath { map }: MapPath,
    Body(new): Body<NewJudgement>,
) -> Result<Response, Problem> {
    let is_preview = new.preview;
    let stored = service.judge_again(&map, new).await?;
    let view = JudgementView::from(stored.value);
    Ok(if is_preview { Json(view).into_response() } else { written(stored.created, view) })
}

/// Read a re-evaluation job
///
/// Returns its progress and the verdicts that it has replaced.
#[utoipa::path(
    get, path = "/v1/maps/{map}/judgements/{id}", tag = "anchors", params(JudgementPath),
    security(("key" = ["read"])),
    responses((status = 200, description = "The job", body = JudgementView, example = examples::judgement), ReadErrors)
)]
pub async fn get_judgement(
    State(service): State<Service>,
    JudgementPath { map, id }: JudgementPath,
) -> Result<Json<JudgementView>, Problem> {
    Ok(Json(service.judgement(&map, &id).await?.into()))
}

/// Stop a re-evaluation job
///
/// Its results so far are kept. The job can still be read; a finished job does not change.
#[utoipa::path(
    delete, path = "/v1/maps/{map}/judgements/{id}", tag = "anchors", params(JudgementPath),
    security(("key" = ["write"])),
    responses(
        (status = 200, description = "The job is stopped", body = JudgementView, example = examples::judgement),
        OfDelete
    )
)]
pub async fn stop_judgement(
    State(service): State<Service>,
    JudgementPath { map, id }: JudgementPath,
) -> Result<Json<JudgementView>, Problem> {
    Ok(Json(service.stop_judgement(&map, &id).await?.into()))
}
