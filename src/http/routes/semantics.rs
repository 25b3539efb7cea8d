//! Semantics: the judge asked by hand, to see why two texts match or do not.

use axum::Json;

use crate::http::body::Body;
use crate::http::problem::Problem;
use crate::http::refusals::OfQuestion;
use crate::semantics::{self, Text};
use crate::wire::examples;
use crate::wire::semantics::{LevelAnswer, MergeAnswer, OneText, TextPair};

/// Who judges where no model does.
const BUILT_IN: &str = "lexical";

/// SimilarityLevel of two descriptions
///
/// 1 different objects, 5 the same.
#[utoipa::path(
    post, path = "/v1/semantics/similarity", tag = "semantics",
    request_body(content = TextPair, example = examples::text_pair),
    responses((status = 200, description = "The level", body = LevelAnswer, example = examples::similarity), OfQuestion)
)]
pub async fn similarity(Body(pair): Body<TextPair>) -> Result<Json<LevelAnswer>, Problem> {
    let judgement = semantics::similarity(&Text::parse(&pair.a), &Text::parse(&pair.b));
    Ok(Json(level(judgement.level, judgement.source.as_str(), judgement.reason)))
}

/// InformationLevel of a description
///
/// 1 says nothing, 5 an identifier in context.
#[utoipa::path(
    post, path = "/v1/semantics/information", tag = "semantics",
    request_body(content = OneText, example = examples::one_text),
    responses((status = 200, description = "The level", body = LevelAnswer, example = examples::information), OfQuestion)
)]
pub async fn information(Body(one): Body<OneText>) -> Result<Json<LevelAnswer>, Problem> {
    let (information, reason) = semantics::information(&Text::parse(&one.text));
    Ok(Json(level(information, BUILT_IN, reason)))
}

/// MergeText of two descriptions
///
/// One description of what both describe.
#[utoipa::path(
    post, path = "/v1/semantics/merge", tag = "semantics",
    request_body(content = TextPair, example = examples::text_pair),
    responses((status = 200, description = "The description", body = MergeAnswer, example = examples::merged_text), OfQuestion)
)]
pub async fn merge_text(Body(pair): Body<TextPair>) -> Result<Json<MergeAnswer>, Problem> {
    let text = semantics::merge(&pair.a, &pair.b);
    Ok(Json(MergeAnswer { text, source: BUILT_IN.to_owned(), cached: false, degraded: false }))
}

fn level(level: u8, source: &str, reason: String) -> LevelAnswer {
    LevelAnswer { level, source: source.to_owned(), reason, cached: false, degraded: false }
}
