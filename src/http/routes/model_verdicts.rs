//! Model verdicts: imported from models elsewhere.

use axum::Json;
use axum::extract::State;

use crate::api::examples;
use crate::api::model_verdict::{ModelVerdictAnswer, ModelVerdictBody};
use crate::domain::request::NewVerdict;
use crate::engine::Service;
use crate::http::error_responses::OfWrite;
use crate::http::extract::body::Body;
use crate::http::extract::path::MapPath;
use crate::http::problem::Problem;

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
) -> Result<Json<ModelVerdictAnswer>, Problem> {
    let (map_version, applied) = service.bring_verdict(&map, new).await?;
    Ok(Json(ModelVerdictAnswer { map_version, applied }))
}
