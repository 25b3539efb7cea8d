//! Bulk: many keyframes in one request, each with its own result.

use axum::body::Body;
use axum::extract::{Extension, Request, State};
use axum::http::StatusCode;
use axum::http::header::CONTENT_TYPE;
use axum::response::{IntoResponse, Response};
use bytes::Bytes;
use serde_json::Value;

use super::lines::{Line, Lines};
use crate::http::body::{decoded, expect_type};
use crate::http::envelope::RequestId;
use crate::http::path::{InMap, MapPath};
use crate::http::problem::{Kind, Problem};
use crate::http::refusals::OfWrite;
use crate::model::ids::MapId;
use crate::service::Service;
use crate::wire::bulk::{self, BulkItem, BulkLine};
use crate::wire::examples;
use crate::wire::limits;

const NDJSON: &str = "application/x-ndjson";

/// Store many keyframes
///
/// One keyframe a line, each with its `id`; blank lines are passed over. They are stored in their order, each for itself:
/// a bad line gets its problem and the others go on. The answer has one line an item.
#[utoipa::path(
    post, path = "/v1/maps/{map}/keyframes", tag = "keyframes", params(MapPath),
    request_body(content = BulkItem, content_type = "application/x-ndjson", example = examples::bulk_body),
    responses(
        (status = 200, description = "Every keyframe is stored", body = BulkLine, content_type = "application/x-ndjson",
            example = examples::bulk_line),
        (status = 207, description = "Some are not; each line tells", body = BulkLine,
            content_type = "application/x-ndjson", example = examples::bulk_line),
        OfWrite
    )
)]
pub async fn put_keyframes(
    State(service): State<Service>,
    InMap(map): InMap,
    Extension(request_id): Extension<RequestId>,
    request: Request,
) -> Result<Response, Problem> {
    let accepted =
        ["application/x-ndjson", "application/ndjson", "application/jsonl", "application/x-jsonlines"];
    expect_type(request.headers(), |essence| accepted.contains(&essence), NDJSON)?;
    service.get_map(&map).await?;
    let mut answer = Answer::of(&request_id);
    answer.take(&service, &map, request.into_body()).await;
    Ok(answer.into_response())
}

/// The lines answered so far. They are kept until the end, for only then is it known whether any failed.
struct Answer {
    request_id: String,
    lines: Vec<u8>,
    items: usize,
    failed: bool,
}

impl Answer {
    fn of(request_id: &RequestId) -> Self {
        Self { request_id: request_id.to_string(), lines: Vec::new(), items: 0, failed: false }
    }

    async fn take(&mut self, service: &Service, map: &MapId, body: Body) {
        let mut lines = Lines::of(body);
        for number in 1.. {
            let line = match lines.next().await {
                Ok(Some(line)) => line,
                Ok(None) => return,
                // What came before is stored: the answer says so, and in its last line what broke off.
                Err(problem) => return self.refused(number, None, problem),
            };
            let text = match line {
                Line::Text(text) if text.trim_ascii().is_empty() => continue,
                Line::Text(text) => text,
                Line::TooLong => {
                    let detail = format!("a line has at most {} bytes", limits::LINE_BYTES);
                    self.refused(number, None, Problem::new(Kind::TOO_LARGE, detail));
                    continue;
                }
            };
            if self.items == limits::BULK_ITEMS {
                let detail = format!(
                    "a bulk request has at most {} items; the rest is not stored",
                    limits::BULK_ITEMS
                );
                return self.refused(number, None, Problem::new(Kind::TOO_LARGE, detail));
            }
            self.items += 1;
            match store(service, map, text).await {
                Ok((stored, line)) => self.push(&BulkLine { line: number, ..line }, stored),
                Err((id, problem)) => self.refused(number, id, problem),
            }
        }
    }

    fn refused(&mut self, line: usize, id: Option<String>, problem: Problem) {
        if let Some(cause) = problem.cause() {
            tracing::error!(request_id = self.request_id, line, cause, "bulk item failed");
        }
        self.push(&BulkLine::refused(line, id, problem.view(&self.request_id)), false);
    }

    fn push(&mut self, line: &BulkLine, stored: bool) {
        self.failed |= !stored;
        // Writing into a vector does not fail.
        let _ = serde_json::to_writer(&mut self.lines, line);
        self.lines.push(b'\n');
    }
}

impl IntoResponse for Answer {
    fn into_response(self) -> Response {
        let status = if self.failed { StatusCode::MULTI_STATUS } else { StatusCode::OK };
        (status, [(CONTENT_TYPE, NDJSON)], self.lines).into_response()
    }
}

/// Stores one line; a refusal comes with the id, if the line has one.
async fn store(
    service: &Service,
    map: &MapId,
    text: Bytes,
) -> Result<(bool, BulkLine), (Option<String>, Problem)> {
    let read = |line: Value| Ok((bulk::line_id(&line), bulk::decode(line)));
    let (id, sent) = decoded(text, read).await.map_err(|problem| (None, problem))?;
    let sent = sent.map_err(|faults| (id.clone(), Problem::invalid(faults)))?;
    let stored =
        service.put_keyframe(map, sent.keyframe, sent.digest).await.map_err(|error| (id, error.into()))?;
    let status = if stored.created { StatusCode::CREATED } else { StatusCode::OK };
    Ok((true, BulkLine::stored(0, status.as_u16(), !stored.created, stored.value.into())))
}
