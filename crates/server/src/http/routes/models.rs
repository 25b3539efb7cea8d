//! Models: what they judge and cost, verdicts from elsewhere, and jobs that ask a changed model again.

use axum::Json;
use axum::extract::State;
use axum::response::{IntoResponse as _, Response};

use crate::api::examples;
use crate::api::judgement::{JudgementBody, JudgementView};
use crate::api::model_verdict::{ModelVerdictAnswer, ModelVerdictBody};
use crate::api::semantics::{LevelAnswer, MergeAnswer, OneText, TextPair};
use crate::api::usage::Usage;
use crate::domain::request::{NewJudgement, NewVerdict};
use crate::engine::Service;
use crate::http::answer::{Answer, written};
use crate::http::error_responses::{OfDelete, OfQuestion, OfReadiness, OfWrite, ReadErrors};
use crate::http::extract::body::Body;
use crate::http::extract::path::{JudgementPath, MapPath};
use crate::http::guards::access::Caller;
use crate::http::problem::Problem;

/// SimilarityLevel of two descriptions
///
/// From 1, different objects, to 5, the same object.
#[utoipa::path(
    post, path = "/v1/semantics/similarity", tag = "semantics", security(("key" = ["query"])),
    request_body(content = TextPair, example = examples::text_pair),
    responses((status = 200, description = "The level", body = LevelAnswer, example = examples::similarity), OfQuestion)
)]
pub async fn similarity(
    State(service): State<Service>,
    caller: Caller,
    Body(pair): Body<TextPair>,
) -> Answer<LevelAnswer> {
    let class = pair.class.as_deref().unwrap_or_default();
    Ok(Json(service.judge(&caller.0).similarity(class, &pair.a, &pair.b).await.into()))
}

/// InformationLevel of a description
///
/// From 1, no information, to 5, an identifier in context.
#[utoipa::path(
    post, path = "/v1/semantics/information", tag = "semantics", security(("key" = ["query"])),
    request_body(content = OneText, example = examples::one_text),
    responses((status = 200, description = "The level", body = LevelAnswer, example = examples::information), OfQuestion)
)]
pub async fn information(
    State(service): State<Service>,
    caller: Caller,
    Body(one): Body<OneText>,
) -> Answer<LevelAnswer> {
    let class = one.class.as_deref().unwrap_or_default();
    Ok(Json(service.judge(&caller.0).information(class, &one.text).await.into()))
}

/// MergeText of two descriptions
///
/// Merges two descriptions of one object into one.
#[utoipa::path(
    post, path = "/v1/semantics/merge", tag = "semantics", security(("key" = ["query"])),
    request_body(content = TextPair, example = examples::text_pair),
    responses((status = 200, description = "The description", body = MergeAnswer, example = examples::merged_text), OfQuestion)
)]
pub async fn merge_text(
    State(service): State<Service>,
    caller: Caller,
    Body(pair): Body<TextPair>,
) -> Answer<MergeAnswer> {
    let class = pair.class.as_deref().unwrap_or_default();
    Ok(Json(service.judge(&caller.0).merge(class, &pair.a, &pair.b).await.into()))
}

/// Read the usage of models
///
/// Calls, tokens and cost since the database was created, and today's usage against its limits.
#[utoipa::path(
    get, path = "/v1/usage", tag = "semantics", security(("key" = ["read"])),
    responses((status = 200, description = "The usage", body = Usage, example = examples::usage), OfReadiness)
)]
pub async fn get_usage(State(service): State<Service>) -> Json<Usage> {
    Json(service.usage().map_or_else(Usage::without_models, Usage::from))
}

/// Import a model verdict
///
/// A level or a merged text of texts of one class, or the description of a detection's crop. It is applied like a
/// verdict of this server's model, and calls none. A copy of a map, or a model that runs elsewhere, can import
/// verdicts this way. It has no effect if no anchor has these texts, or if the crop's reading is final.
#[utoipa::path(
    post, path = "/v1/maps/{map}/model-verdicts", tag = "anchors", params(MapPath), security(("key" = ["write"])),
    request_body(content = ModelVerdictBody, example = examples::model_verdict),
    responses(
        (status = 200, description = "The result", body = ModelVerdictAnswer, example = examples::model_verdict_answer),
        OfWrite
    )
)]
pub async fn bring_model_verdict(
    State(service): State<Service>,
    MapPath { map }: MapPath,
    Body(new): Body<NewVerdict>,
) -> Answer<ModelVerdictAnswer> {
    let (map_version, applied) = service.bring_verdict(&map, new).await?;
    Ok(Json(ModelVerdictAnswer { map_version, applied }))
}

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
) -> Answer<JudgementView> {
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
) -> Answer<JudgementView> {
    Ok(Json(service.stop_judgement(&map, &id).await?.into()))
}
