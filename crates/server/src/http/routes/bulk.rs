//! Bulk: many keyframes in one request, each with its own result.

use std::collections::VecDeque;
use std::pin::pin;

use axum::extract::{Extension, Request, State};
use axum::http::StatusCode;
use axum::http::header::CONTENT_TYPE;
use axum::response::{IntoResponse, Response};
use futures_util::FutureExt;
use futures_util::future::BoxFuture;

use super::lines::{Line, Lines};
use crate::api::bulk::{self, BulkItem, BulkLine};
use crate::api::decoding::document::Document;
use crate::api::examples;
use crate::api::keyframe::SentKeyframe;
use crate::api::limits;
use crate::domain::report::KeyframeReport;
use crate::engine::keys::access::Access;
use crate::engine::keys::keyring::now;
use crate::engine::{PendingKeyframe, PinnedMap, ServiceError, Stored};
use crate::http::App;
use crate::http::envelope::RequestId;
use crate::http::error_responses::OfWrite;
use crate::http::extract::body::{Text, all_faults, decoded, expect_type};
use crate::http::extract::decompression::Encoding;
use crate::http::extract::path::MapPath;
use crate::http::guards::access::Caller;
use crate::http::guards::admission::HeldPermit;
use crate::http::problem::{Kind, Problem};

pub(super) const NDJSON: &str = "application/x-ndjson";

/// Store many keyframes
///
/// One keyframe per line, each with its `id`; blank lines are skipped. Lines are stored in order and independently: an
/// invalid line gets its problem, and the others continue. The response has one line per item.
#[utoipa::path(
    post, path = "/v1/maps/{map}/keyframes", tag = "keyframes", params(MapPath), security(("key" = ["write"])),
    request_body(content = BulkItem, content_type = "application/x-ndjson", example = examples::bulk_body),
    responses(
        (status = 200, description = "Every keyframe is stored", body = BulkLine, content_type = "application/x-ndjson",
            example = examples::bulk_line),
        (status = 207, description = "Some are not; each line has its result", body = BulkLine,
            content_type = "application/x-ndjson", example = examples::bulk_line),
        OfWrite
    )
)]
pub async fn put_keyframes(
    State(app): State<App>,
    caller: Caller,
    MapPath { map }: MapPath,
    Extension(request_id): Extension<RequestId>,
    Extension(working): Extension<HeldPermit>,
    request: Request,
) -> Result<Response, Problem> {
    let accepted =
        ["application/x-ndjson", "application/ndjson", "application/jsonl", "application/x-jsonlines"];
    expect_type(request.headers(), |essence| accepted.contains(&essence), NDJSON)?;
    let encoding = Encoding::of(request.headers())?;
    let map = app.service.pin_map(&map).await?;
    let lines = Lines::of(request.into_body(), encoding, app.memory.clone())?;
    let mut answer = Answer::of(app, map, caller.0, &request_id);
    answer.take(lines, &working).await;
    Ok(answer.into_response())
}

/// Maximum lines of one request that wait for the disk: twice as many as share a sync, and few compared with other
/// requests.
const UNDER_WAY_MAX: usize = 128;

/// Maximum lines of one request, including blank ones: a few compressed bytes can hold a billion of them.
const LINES_MAX: usize = 10 * limits::BULK_ITEMS;

/// Maximum bytes of errors in the response: a robot's upload has few, but a small body can contain many invalid lines.
/// Above half of it, only the first fault of a line is listed.
const REFUSALS_BYTES: usize = 2 << 20;

/// A decided line that is being written to disk.
struct UnderWay {
    line: usize,
    id: Option<String>,
    committed: BoxFuture<'static, Result<Stored<KeyframeReport>, ServiceError>>,
}

/// The lines answered so far. They are kept until the end, which decides whether any failed.
struct Answer {
    app: App,
    map: PinnedMap,
    access: Access,
    request_id: String,
    lines: Vec<u8>,
    items: usize,
    failed: bool,
    refusals_bytes: usize,
    under_way: VecDeque<UnderWay>,
}

impl Answer {
    fn of(app: App, map: PinnedMap, access: Access, request_id: &RequestId) -> Self {
        Self {
            app,
            map,
            access,
            request_id: request_id.to_string(),
            lines: Vec::new(),
            items: 0,
            failed: false,
            refusals_bytes: 0,
            under_way: VecDeque::new(),
        }
    }

    async fn take(&mut self, mut lines: Lines, working: &HeldPermit) {
        for number in 1.. {
            let line = match self.next_line(&mut lines).await {
                Ok(Some(line)) => line,
                Ok(None) => return self.all_committed().await,
                // Earlier lines are stored: the response lists them, and its last line has the error.
                Err(problem) => return self.refused(number, None, problem).await,
            };
            if number > LINES_MAX {
                let detail = format!("a bulk request has at most {LINES_MAX} lines; the rest is not stored");
                return self.broken_off(number, Problem::new(Kind::TOO_LARGE, detail), lines).await;
            }
            let text = match line {
                Line::Text(text) if text.trim_ascii().is_empty() => continue,
                Line::Text(text) => text,
                Line::TooLong => {
                    let detail = format!(
                        "a line has at most {} bytes, and fewer if it was compressed to a few",
                        limits::LINE_BYTES
                    );
                    self.refused(number, None, Problem::new(Kind::TOO_LARGE, detail)).await;
                    continue;
                }
            };
            if self.refusals_bytes > REFUSALS_BYTES {
                let detail = "too many lines were rejected; the rest is not stored";
                return self.broken_off(number, Problem::new(Kind::TOO_LARGE, detail), lines).await;
            }
            if self.items == limits::BULK_ITEMS {
                let detail = format!(
                    "a bulk request has at most {} items; the rest is not stored",
                    limits::BULK_ITEMS
                );
                return self.broken_off(number, Problem::new(Kind::TOO_LARGE, detail), lines).await;
            }
            self.items += 1;
            // The first line was counted with the request.
            if self.items > 1 {
                self.key_allows(working).await;
            }
            if !self.app.service.keys().is_good(&self.access) {
                return self.broken_off(number, access_ended(&self.access), lines).await;
            }
            let text = Text::line(text, lines.becomes_at_most());
            match begin(&self.app, &self.map, text).await {
                Ok((id, keyframe)) => {
                    let committed = keyframe.committed().boxed();
                    self.under_way.push_back(UnderWay { line: number, id, committed });
                }
                Err((id, problem)) => self.refused(number, id, problem).await,
            }
            if self.under_way.len() > UNDER_WAY_MAX {
                self.oldest_committed().await;
            }
        }
    }

    /// Returns the next line. While waiting for it, earlier lines are answered as they reach the disk: a request must not hold
    /// its write permit while it waits for its client. A line that arrives first is decided at once, so that it shares the
    /// next sync with all others that came during this one.
    async fn next_line(&mut self, lines: &mut Lines) -> Result<Option<Line>, Problem> {
        let mut next = pin!(lines.next());
        loop {
            tokio::select! {
                biased;
                line = &mut next => return line,
                () = self.oldest_committed(), if !self.under_way.is_empty() => {}
            }
        }
    }

    /// Waits until the key's rate allows another line: a bulk upload is throttled where single requests are rejected.
    /// Meanwhile it holds no permit, neither as a request nor for its pending writes, so it delays no other client.
    async fn key_allows(&mut self, working: &HeldPermit) {
        let Access::Key(held) = self.access.clone() else { return };
        if held.count(now().sec).is_err() {
            self.all_committed().await;
            working.release_while(held.wait()).await;
        }
    }

    /// Rejects the rest of the request.
    async fn broken_off(&mut self, number: usize, problem: Problem, mut lines: Lines) {
        self.refused(number, None, problem).await;
        lines.discard().await;
    }

    /// Answers the oldest pending line, once it is on disk. It may be cancelled: the line then stays pending.
    async fn oldest_committed(&mut self) {
        let Some(oldest) = self.under_way.front_mut() else { return };
        let result = oldest.committed.as_mut().await;
        let Some(UnderWay { line, id, .. }) = self.under_way.pop_front() else { return };
        match result {
            Ok(stored) => {
                let status = if stored.created { StatusCode::CREATED } else { StatusCode::OK };
                let answer = BulkLine::stored(line, status.as_u16(), !stored.created, stored.value.into());
                self.push(&answer, true);
            }
            Err(error) => self.push_refused(line, id, error.into()),
        }
    }

    /// Answers all pending lines, in order.
    async fn all_committed(&mut self) {
        // No line follows that they could wait for.
        self.app.service.commit_held();
        while !self.under_way.is_empty() {
            self.oldest_committed().await;
        }
    }

    async fn refused(&mut self, line: usize, id: Option<String>, problem: Problem) {
        self.all_committed().await;
        self.push_refused(line, id, problem);
    }

    fn push_refused(&mut self, line: usize, id: Option<String>, problem: Problem) {
        if let Some(cause) = problem.cause() {
            tracing::error!(request_id = self.request_id, line, cause, "bulk item failed");
        }
        let mut view = problem.view(&self.request_id);
        if self.refusals_bytes > REFUSALS_BYTES / 2 {
            view.errors.truncate(1);
        }
        let before = self.lines.len();
        self.push(&BulkLine::refused(line, id, view), false);
        self.refusals_bytes += self.lines.len() - before;
    }

    fn push(&mut self, line: &BulkLine, stored: bool) {
        self.failed |= !stored;
        // Writing to a vector does not fail.
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

/// Returns the problem of the remaining lines when the key is revoked or expires, or when the first key is created.
fn access_ended(access: &Access) -> Problem {
    let detail = match access {
        Access::Open => "a key was created meanwhile, so requests need one now; the rest is not stored",
        Access::Key(_) => "the key has expired or was revoked meanwhile; the rest is not stored",
    };
    Problem::new(Kind::UNAUTHORIZED, detail)
}

/// Decides one line and queues it; an error has the line's id, if known.
async fn begin(
    app: &App,
    map: &PinnedMap,
    text: Text,
) -> Result<(Option<String>, PendingKeyframe), (Option<String>, Problem)> {
    let read = |line: &Document<'_>| (bulk::line_id(line.root()), bulk::decode(line.root()));
    let (id, sent) = decoded(text, app, read).await.map_err(|problem| (None, problem))?;
    let SentKeyframe { keyframe, digest } = match sent {
        Ok(sent) => sent,
        Err(faulty) => return Err((id, all_faults(app, &map.id, "", faulty).await)),
    };
    match app.service.begin_keyframe(map, keyframe, digest).await {
        Ok(keyframe) => Ok((id, keyframe)),
        Err(error) => Err((id, error.into())),
    }
}
