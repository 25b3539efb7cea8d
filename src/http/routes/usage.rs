//! Usage: what models were asked.

use axum::Json;

use crate::http::refusals::OfNobody;
use crate::wire::examples;
use crate::wire::usage::Usage;

/// Read the usage of models
///
/// Calls, tokens and cost since the server started.
#[utoipa::path(
    get, path = "/v1/usage", tag = "semantics",
    responses((status = 200, description = "The usage", body = Usage, example = examples::usage), OfNobody)
)]
pub async fn get_usage() -> Json<Usage> {
    Json(Usage::without_models())
}
