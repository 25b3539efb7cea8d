//! "Where am I?"

use axum::Json;
use axum::extract::State;
use axum::response::{IntoResponse as _, Response};

use super::loop_queries::{SERVER_TIMING, server_timing};
use crate::api::examples;
use crate::api::location::{AskedMapView, LocateAnswerView, LocateBody};
use crate::domain::location::LocateRequest;
use crate::engine::Service;
use crate::http::error_responses::OfMapQuestion;
use crate::http::extract::body::Body;
use crate::http::guards::access::Caller;
use crate::http::problem::Problem;

/// Find where a keyframe was taken
///
/// The keyframe need not have a pose: it is held against one, several or all maps that the key may query. The answer is
/// `located` only where the confidence is at least 0.99. Where several places fit, it is `ambiguous`, and `look_for` names
/// signs that would tell them apart; else it is `unknown`. The question stores nothing and calls no model. At most 64 maps are
/// asked, and geometry looks at 20 pairs of keyframes at most.
#[utoipa::path(
    post, path = "/v1/locate", tag = "loops", security(("key" = ["query"])),
    request_body(content = LocateBody, example = examples::locate),
    responses((status = 200, description = "The places", body = LocateAnswerView, example = examples::locate_answer), OfMapQuestion)
)]
pub async fn locate(
    State(service): State<Service>,
    caller: Caller,
    Body(request): Body<LocateRequest>,
) -> Result<Response, Problem> {
    let answer = service.locate(request, |map| caller.reaches(map)).await?;
    let asked =
        |map: &crate::engine::AskedMap| AskedMapView::of(&map.id, map.version, map.are_words_compared);
    let maps = answer.maps.iter().map(asked).collect();
    let body = Json(LocateAnswerView::of(maps, answer.keyframes, &answer.location));
    Ok(([(SERVER_TIMING, server_timing(answer.timings))], body).into_response())
}
