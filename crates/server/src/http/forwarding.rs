//! Forwarding: a request about a map that another server has is sent on to that one, and its answer back.
//!
//! A client that says which version it has seen may be answered here, by a copy that has that version.
//!
//! Bodies are streamed both ways. The key goes with the request, and is checked there once more. A request is sent on once
//! at most: what comes from another server, which shows this one's secret, is answered here or not at all.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use axum::body::Body;
use axum::extract::{MatchedPath, Request, State};
use axum::http::header::{CONNECTION, HOST};
use axum::http::{HeaderMap, HeaderName, HeaderValue, StatusCode};
use axum::middleware::Next;
use axum::response::{IntoResponse as _, Response};
use futures_util::TryStreamExt as _;

use super::App;
use super::envelope::{OfPeer, REQUEST_ID, RequestId};
use super::extract::answering::FromCopy;
use super::extract::body_errors::fault_of_client;
use super::extract::min_version::{MIN_VERSION, take_min_version};
use super::guards::access::map_of;
use super::guards::admission::HeldPermit;
use super::peers::FORWARDED;
use super::problem::{Kind, Problem};
use crate::config::tls;
use crate::domain::ids::MapId;
use crate::engine::{Route, ServiceError};
use crate::store::Node;

/// The header with the address of the server that has the map: a client may ask it directly from then on.
const OWNER: HeaderName = HeaderName::from_static("x-revisit-owner");

/// The beginning of routes about one map.
const OF_MAP: &str = "/v1/maps/{map}";

/// Headers of one connection, which end with it (RFC 9110, section 7.6.1).
const HOP_BY_HOP: [&str; 8] = [
    "connection",
    "keep-alive",
    "proxy-authenticate",
    "proxy-authorization",
    "proxy-connection",
    "te",
    "transfer-encoding",
    "upgrade",
];

/// Middleware that sends requests about maps of other servers on, or has a copy answer them, where the client says which
/// version it has seen.
pub async fn forward(State(app): State<App>, request: Request, next: Next) -> Result<Response, Problem> {
    let Some(route) =
        request.extensions().get::<MatchedPath>().filter(|route| route.as_str().starts_with(OF_MAP))
    else {
        return Ok(next.run(request).await);
    };
    let route = route.clone();
    let (mut parts, body) = request.into_parts();
    let min_version = take_min_version(&mut parts, route.as_str())?;
    // Most servers are alone, and most requests say nothing: they go on as they are.
    if app.service.address().is_none() && min_version.is_none() {
        return Ok(next.run(Request::from_parts(parts, body)).await);
    }
    let Some(map) = map_of(&mut parts).await else {
        return Ok(next.run(Request::from_parts(parts, body)).await);
    };
    let forwarded = parts.headers.remove(FORWARDED);
    let mut request = Request::from_parts(parts, body);
    let Some(address) = app.service.address() else {
        return Ok(here(&app, &map, min_version, request, next).await);
    };
    let is_from_peer = forwarded.as_ref().is_some_and(|secret| app.service.is_from_peer(secret.as_bytes()));
    let to = if is_from_peer { Route::Here } else { app.service.route(&map).await? };
    let node = match to {
        Route::Here => return Ok(with_owner(here(&app, &map, min_version, request, next).await, address)),
        // Meant for a server that was here before, or made up: sent on, it could come back.
        Route::At(_) if forwarded.is_some() => {
            return Err(Problem::new(Kind::UNAVAILABLE, "another server has this map; try again"));
        }
        Route::At(node) => node,
    };
    // Else two servers that are full of each other's requests would wait for each other.
    let held = request.extensions().get::<HeldPermit>().cloned().unwrap_or_default();
    if let Some(version) = min_version {
        if is_answered_from_copies(route.as_str()) {
            match held.release_while(app.following.reach(&map, version)).await {
                Ok(()) => {
                    request.extensions_mut().insert(FromCopy);
                    app.metrics.forwarded("copied");
                    return Ok(with_owner(next.run(request).await, &node.address));
                }
                Err(error @ ServiceError::PreconditionFailed(_)) => {
                    return Ok(with_owner(Problem::from(error).into_response(), &node.address));
                }
                // The owner may still know.
                Err(error) => tracing::debug!(%map, %error, "a copy did not answer"),
            }
        }
        request.headers_mut().insert(MIN_VERSION, version.into());
    }
    let sent_on = held.release_while(sent_on(&app, &map, &node, request)).await;
    if !matches!(&sent_on, Ok(response) if response.status() != StatusCode::SERVICE_UNAVAILABLE) {
        app.service.ask_for_owner_again(&map);
    }
    app.metrics.forwarded(if sent_on.is_ok() { "answered" } else { "failed" });
    Ok(with_owner(sent_on?, &node.address))
}

/// Answers by this server's own map, once that has the version that the client has seen.
async fn here(app: &App, map: &MapId, min_version: Option<u64>, request: Request, next: Next) -> Response {
    if let Some(version) = min_version {
        let held = request.extensions().get::<HeldPermit>().cloned().unwrap_or_default();
        if let Err(error) = held.release_while(app.service.reach(map, version)).await {
            return Problem::from(error).into_response();
        }
    }
    next.run(request).await
}

/// Whether a copy of the map may answer a request for a route: the others are the owner's, which keeps what they read.
fn is_answered_from_copies(route: &str) -> bool {
    const ROUTES: [&str; 13] = [
        "",
        "/keyframes",
        "/keyframes/{keyframe}",
        "/keyframes/{keyframe}/covisible",
        "/keyframes/{keyframe}/local-anchor-map",
        "/trajectory",
        "/sessions",
        "/loops",
        "/anchors",
        "/anchors/{anchor}",
        "/anchors/{anchor}/crop",
        "/anchors/{anchor}/transcript",
        "/loop-queries",
    ];
    route.strip_prefix(OF_MAP).is_some_and(|rest| ROUTES.contains(&rest))
}

fn with_owner(mut response: Response, address: &str) -> Response {
    if let Ok(address) = HeaderValue::from_str(address) {
        response.headers_mut().entry(OWNER).or_insert(address);
    }
    response
}

async fn sent_on(app: &App, map: &MapId, node: &Node, request: Request) -> Result<Response, Problem> {
    let away = |error: &reqwest::Error| {
        let cause = tls::cause_of(error);
        tracing::warn!(node = node.id, address = node.address, cause, "a request could not be sent on");
        Problem::new(
            Kind::UNAVAILABLE,
            "the server that has this map does not answer; another one takes it soon",
        )
    };
    let client = app.peers.client(&node.address).map_err(|error| away(&error))?;
    let (parts, body) = request.into_parts();
    let path = parts.uri.path_and_query().map_or("/", |path| path.as_str());
    let mut headers = end_to_end(parts.headers);
    headers.remove(HOST);
    if let Some(id) = parts.extensions.get::<RequestId>()
        && let Ok(id) = HeaderValue::from_str(&id.to_string())
    {
        headers.insert(REQUEST_ID, id);
    }
    if let Ok(secret) = HeaderValue::from_str(&node.secret) {
        headers.insert(FORWARDED, secret);
    }
    let url = format!("{}{path}", node.address.trim_end_matches('/'));
    let sent = client.request(parts.method, url).headers(headers);
    // A client that breaks its body off looks like a server that does not answer.
    let is_broken_off = Arc::new(AtomicBool::new(false));
    let breaks_off = is_broken_off.clone();
    let body = body.into_data_stream().inspect_err(move |_| breaks_off.store(true, Ordering::Relaxed));
    let sent = sent.body(reqwest::Body::wrap_stream(body)).send().await;
    let answer = sent.map_err(|error| {
        fault_of_client(&error).unwrap_or_else(|| {
            if !is_broken_off.load(Ordering::Relaxed) {
                app.service.load_ahead(map, node);
            }
            away(&error)
        })
    })?;
    let (status, headers) = (answer.status(), end_to_end(answer.headers().clone()));
    let mut response = Response::new(Body::from_stream(answer.bytes_stream().map_err(std::io::Error::other)));
    *response.status_mut() = status;
    *response.headers_mut() = headers;
    response.extensions_mut().insert(OfPeer);
    Ok(response)
}

/// Returns the headers without those of one connection, and those that `connection` names.
fn end_to_end(mut headers: HeaderMap) -> HeaderMap {
    let named: Vec<String> = headers
        .get_all(CONNECTION)
        .iter()
        .filter_map(|value| value.to_str().ok())
        .flat_map(|value| value.split(','))
        .map(|name| name.trim().to_ascii_lowercase())
        .collect();
    for name in HOP_BY_HOP.into_iter().chain(named.iter().map(String::as_str)) {
        headers.remove(name);
    }
    headers
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headers_of_one_connection_end_with_it() {
        let mut headers = HeaderMap::new();
        for (name, value) in
            [("connection", "close, X-Hop"), ("x-hop", "1"), ("te", "trailers"), ("etag", "\"1\"")]
        {
            headers.append(
                HeaderName::from_bytes(name.as_bytes()).expect("a name"),
                HeaderValue::from_static(value),
            );
        }
        let left = end_to_end(headers);
        assert_eq!(left.keys().map(HeaderName::as_str).collect::<Vec<_>>(), ["etag"]);
    }
}
