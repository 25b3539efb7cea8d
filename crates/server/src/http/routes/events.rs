//! Events: a map's event stream, resumable at any event.

use std::convert::Infallible;
use std::time::Duration;

use axum::extract::{FromRequestParts, State};
use axum::http::request::Parts;
use axum::response::sse::{Event as Sent, KeepAlive, Sse};
use futures_util::Stream;

use crate::api::event::EventView;
use crate::api::examples;
use crate::domain::event::Event;
use crate::domain::invalid::FieldError;
use crate::engine::Listener;
use crate::engine::Route;
use crate::engine::keys::access::Access;
use crate::engine::{PinnedMap, ServiceError};
use crate::http::App;
use crate::http::error_responses::OfStream;
use crate::http::extract::path::MapPath;
use crate::http::extract::query::{Query, Since};
use crate::http::guards::access::Caller;
use crate::http::guards::stream_limit::Listening;
use crate::http::problem::{Kind, Problem};

/// Maximum events fetched together.
const BATCH: usize = 256;
/// Interval of looks whether another server has the map by now, where there may be others.
const MOVED_EVERY: Duration = Duration::from_secs(3);
/// Interval of comments that keep proxies from closing the stream.
const KEEP_ALIVE: Duration = Duration::from_secs(15);

/// Stream a map's events
///
/// Server-sent events: `id` is a sequence number, `event` the kind, `data` an Event as JSON. A client that reconnects
/// with `last-event-id`, as browsers do, misses nothing. If it would, because the map was recreated or the event is
/// too old, the response is 410. The stream ends with the server, the map or the key, and where a map moves between servers
/// of one database; the client resumes as after any break. The number of streams per key is
/// limited (429).
#[utoipa::path(
    get, path = "/v1/maps/{map}/events", tag = "events", security(("key" = ["read"])),
    params(
        MapPath, Since,
        ("last-event-id" = Option<u64>, Header, description = "The number of the last event seen; overrides `since`",
            example = 30)
    ),
    responses(
        (status = 200, description = "The event stream", body = String, content_type = "text/event-stream",
            example = examples::event_stream),
        OfStream
    )
)]
pub async fn listen(
    State(app): State<App>,
    caller: Caller,
    MapPath { map }: MapPath,
    Query(Since { since }): Query<Since>,
    LastEventId(last): LastEventId,
) -> Result<Sse<impl Stream<Item = Result<Sent, Infallible>>>, Problem> {
    let (from, place) = match last {
        Some(last) => (last, "last-event-id:"),
        None => (since.unwrap_or(0), "?since"),
    };
    let (map, events) =
        app.service.resume_events(&map, from).await.map_err(|error| unresumed(error, place, from))?;
    let listening = app.streams.begin(&caller.0)?;
    let stream = stream(app, caller.0, map, from, events, listening);
    Ok(Sse::new(stream).keep_alive(KeepAlive::new().interval(KEEP_ALIVE)))
}

/// Names the client's parameter if it is the cause.
fn unresumed(error: ServiceError, place: &str, from: u64) -> Problem {
    let is_gone = matches!(error, ServiceError::Gone(_));
    let problem = Problem::from(error);
    if !is_gone {
        return problem;
    }
    let fault = FieldError::new(place, "not the number of a stored event").got(from.to_string());
    problem.with(vec![fault.limit("0, or the number of an event of this map")])
}

fn stream(
    app: App,
    access: Access,
    map: PinnedMap,
    mut since: u64,
    mut listener: Listener,
    listening: Listening,
) -> impl Stream<Item = Result<Sent, Infallible>> {
    async_stream::stream! {
        let _listening = listening;
        loop {
            // Marked as seen before fetching, so that events arriving meanwhile wake the wait below.
            listener.mark_seen();
            // An error here means that the map was deleted; the client receives the reason when it reconnects.
            let Ok(events) = app.service.events(&map, since, BATCH).await else { return };
            let more = !events.is_empty();
            for event in events {
                since = event.seq;
                yield Ok(sent(event));
            }
            if more {
                continue;
            }
            tokio::select! {
                () = listener.more() => {}
                () = app.stopping.cancelled() => return,
                () = app.service.keys().ended(&access) => return,
                () = tokio::time::sleep(MOVED_EVERY), if app.service.address().is_some() => {
                    // Its events are told by the server that has it: the client resumes there.
                    if matches!(app.service.route(&map.id).await, Ok(Route::At(_))) {
                        return;
                    }
                }
            }
        }
    }
}

fn sent(event: Event) -> Sent {
    let (seq, kind) = (event.seq, event.kind);
    let data = serde_json::to_string(&EventView::from(event)).unwrap_or_default();
    Sent::default().id(seq.to_string()).event(kind.as_str()).data(data)
}

/// The header with which a client resumes.
pub struct LastEventId(Option<u64>);

impl<S: Send + Sync> FromRequestParts<S> for LastEventId {
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, _: &S) -> Result<Self, Problem> {
        let Some(header) = parts.headers.get("last-event-id") else { return Ok(Self(None)) };
        let text = header.to_str().unwrap_or_default().trim();
        text.parse().map(|seq| Self(Some(seq))).map_err(|_| {
            let fault =
                FieldError::new("last-event-id:", "not the number of an event").got(text).limit("digits");
            Problem::new(Kind::BAD_REQUEST, "`last-event-id` is malformed").with(vec![fault])
        })
    }
}
