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
use crate::http::extract::path::MapPath;
use crate::http::extract::query::Query;
use crate::http::extract::release_query::ReleaseQuery;
use crate::http::guards::access::Caller;
use crate::http::problem::Problem;

/// Approximate size of the pieces in which lines are sent.
const PIECE_BYTES: usize = 64 << 10;

/// Export a map
///
/// Returns the map as a recording for `revisit replay`: one operation per line, in write order, each with its original
/// body. Poses and positions are the original ones, and corrections follow in order (`keep_history`). Deleted
/// keyframes are omitted, with everything that depends on them. Every keyframe includes its words, even where the
/// server computed them. Replaying it gives a map with the same verdicts, but other ids of anchors and queries. An
/// aborted response is incomplete. At most four exports run at once, two of them for one key.
#[utoipa::path(
    get, path = "/v1/maps/{map}/export", tag = "maps", params(MapPath, ReleaseQuery), security(("key" = ["read"])),
    responses(
        (status = 200, description = "The recording", body = String, content_type = "application/x-ndjson",
            example = "{\"op\":\"map\",\"id\":\"hotel\",\"body\":{}}\n"),
        ReadErrors
    )
)]
pub async fn export_map(
    State(app): State<App>,
    caller: Caller,
    MapPath { map }: MapPath,
    Query(ReleaseQuery { release }): Query<ReleaseQuery>,
) -> Result<Response, Problem> {
    let export = app.service.export(&map, release.as_ref()).await?;
    let headers = [
        (CONTENT_TYPE, NDJSON.to_owned()),
        (CONTENT_DISPOSITION, format!("attachment; filename=\"{map}.ndjson\"")),
    ];
    Ok((headers, Body::from_stream(pieces(app, caller.0, map, export))).into_response())
}

/// Returns the lines of a map. An error aborts the response, so that a partial export is never mistaken for a complete
/// one.
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
                () = app.service.keys().ended(&access) => Err(ServiceError::NotFound("the key has expired or was revoked".to_owned())),
            };
            let next = next.inspect_err(|error| tracing::error!(%map, %error, "an export failed"))?;
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
