//! Usage: calls and cost of models.

use axum::Json;
use axum::extract::State;

use crate::api::examples;
use crate::api::usage::Usage;
use crate::engine::Service;
use crate::http::error_responses::OfReadiness;

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
