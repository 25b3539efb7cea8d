//! Semantics: direct calls of the judge, to see why two texts match or do not.

use axum::Json;
use axum::extract::State;

use crate::api::examples;
use crate::api::semantics::{LevelAnswer, MergeAnswer, OneText, TextPair};
use crate::engine::Service;
use crate::http::error_responses::OfQuestion;
use crate::http::extract::body::Body;
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
) -> Result<Json<LevelAnswer>, Problem> {
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
) -> Result<Json<LevelAnswer>, Problem> {
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
) -> Result<Json<MergeAnswer>, Problem> {
    let class = pair.class.as_deref().unwrap_or_default();
    Ok(Json(service.judge(&caller.0).merge(class, &pair.a, &pair.b).await.into()))
}
