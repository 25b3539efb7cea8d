//! Judgements: jobs that ask a changed model again.

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
use crate::http::extract::path::{JudgementPath, JudgementPathParams, MapPath, MapPathParams};
use crate::http::problem::Problem;

/// Ask a changed model again
///
/// When a model or its prompts change, the verdicts of a map stay as they are until this job asks for them again. With
/// `"preview": true` it only counts the questions and what they may cost. The job goes on in the background, within the
/// budget and over restarts; one job of a map runs at a time. Verdicts that it replaces stay on record, and anchors that
/// were merged stay merged.
#[utoipa::path(
    post, path = "/v1/maps/{map}/judgements", tag = "anchors", params(MapPathParams), security(("key" = ["write"])),
    request_body(content = JudgementBody, example = examples::judgement_body),
    responses(
        (status = 201, description = "The job is started", body = JudgementView, example = examples::judgement),
        (status = 200, description = "A preview, or the job that was started before by this id", body = JudgementView,
            headers(("idempotent-replayed" = String, description = "`true`, unless it is a preview")),
            example = examples::judgement_preview),
        OfWrite
    )
)]
pub async fn judge_again(
    State(service): State<Service>,
    MapPath(map): MapPath,
    Body(new): Body<NewJudgement>,
) -> Result<Response, Problem> {
    let is_preview = new.preview;
    let stored = service.judge_again(&map, new).await?;
    let view = JudgementView::from(stored.value);
    Ok(if is_preview { Json(view).into_response() } else { written(stored.created, view) })
}

/// Read a job that asks again
///
/// How far it is, and which verdicts it has replaced by others.
#[utoipa::path(
    get, path = "/v1/maps/{map}/judgements/{id}", tag = "anchors", params(JudgementPathParams),
    security(("key" = ["read"])),
    responses((status = 200, description = "The job", body = JudgementView, example = examples::judgement), ReadErrors)
)]
pub async fn get_judgement(
    State(service): State<Service>,
    JudgementPath { map, id }: JudgementPath,
) -> Result<Json<JudgementView>, Problem> {
    Ok(Json(service.judgement(&map, &id).await?.into()))
}

/// Stop a job that asks again
///
/// What it has learned stays. The job can still be read; one that has ended stays as it is.
#[utoipa::path(
    delete, path = "/v1/maps/{map}/judgements/{id}", tag = "anchors", params(JudgementPathParams),
    security(("key" = ["write"])),
    responses(
        (status = 200, description = "The job asks nothing more", body = JudgementView, example = examples::judgement),
        OfDelete
    )
)]
pub async fn stop_judgement(
    State(service): State<Service>,
    JudgementPath { map, id }: JudgementPath,
) -> Result<Json<JudgementView>, Problem> {
    Ok(Json(service.stop_judgement(&map, &id).await?.into()))
}
