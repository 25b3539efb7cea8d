//! Export: a map as a recording.

use axum::body::{Body, Bytes};
use axum::extract::State;
use axum::http::header::{CONTENT_DISPOSITION, CONTENT_TYPE};
use axum::response::{IntoResponse, Response};
use futures_util::Stream;

use super::bulk::NDJSON;
use crate::api::recording::write_line;
use crate::domain::ids::MapId;
use crate::engine::keys::access::Access;
use crate::engine::{MapExport, ServiceError};
use crate::http::App;
use crate::http::error_responses::ReadErrors;
use crate::http::extract::path::{MapPath, MapPathParams};
use crate::http::guards::access::Caller;
use crate::http::problem::Problem;

/// Lines are sent in pieces of about this size.
const PIECE_BYTES: usize = 64 << 10;

/// Export a map
///
/// The map as a recording, as `revisit replay` plays it: one operation a line, in the order of writing, each with the body
/// in which it was sent. Poses and positions are those of that time, and corrections follow as they came (`keep_history`).
/// Deleted keyframes are left out, with all that hangs on them. Words stand in every keyframe, also where the server computed
/// them. Playing it gives a map with the same verdicts, under other ids of anchors and queries. An answer that breaks off
/// is not whole; at most two exports run at once.
#[utoipa::path(
    get, path = "/v1/maps/{map}/export", tag = "maps", params(MapPathParams), security(("key" = ["read"])),
    responses(
        (status = 200, description = "The recording", body = String, content_type = "application/x-ndjson",
            example = "{\"op\":\"map\",\"id\":\"hotel\",\"body\":{}}\n"),
        ReadErrors
    )
)]
pub async fn export_map(
    State(app): State<App>,
    caller: Caller,
    MapPath(map): MapPath,
) -> Result<Response, Problem> {
    let export = app.service.export(&map).await?;
    let headers = [
        (CONTENT_TYPE, NDJSON.to_owned()),
        (CONTENT_DISPOSITION, format!("attachment; filename=\"{map}.ndjson\"")),
    ];
    Ok((headers, Body::from_stream(pieces(app, caller.0, map, export))).into_response())
}

/// The lines of a map. An error breaks the answer off, so that no client takes a part for the whole.
fn pieces(
    app: App,
    access: Access,
    map: MapId,
    mut export: MapExport,
) -> impl Stream<Item = Result<Bytes, ServiceError>> {
    async_stream::try_stream! {
        let mut piece = Vec::new();
        loop {
            let next = tokio::select! {
                next = export.next() => next,
                () = app.service.keys().ended(&access) => Err(ServiceError::NotFound("the key has ended".to_owned())),
            };
            let next = next.inspect_err(|error| tracing::error!(%map, %error, "an export broke off"))?;
            let Some(recorded) = next else { break };
            write_line(&map, recorded, &mut piece)
                .map_err(|error| ServiceError::Internal(format!("a line was not written: {error}")))?;
            if piece.len() >= PIECE_BYTES {
                yield Bytes::from(std::mem::take(&mut piece));
            }
        }
        if !piece.is_empty() {
            yield Bytes::from(piece);
        }
    }
}
