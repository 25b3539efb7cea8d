//! Access: the layer that enforces API keys. It works on the matched route and its decoded parameters, never on the raw
//! path, and on the permissions of [`super::route_permissions`].

use std::sync::Arc;

use axum::extract::{FromRequestParts, MatchedPath, RawPathParams, Request, State};
use axum::http::HeaderValue;
use axum::http::header::{ALLOW, AUTHORIZATION, HOST};
use axum::http::request::Parts;
use axum::middleware::Next;
use axum::response::Response;

use super::admission::HeldPermit;
use super::loopback_guard;
use super::route_permissions::Permission;
use crate::domain::ids::MapId;
use crate::domain::key::{Action, MapPattern};
use crate::engine::ServiceError;
use crate::engine::keys::access::Access;
use crate::engine::keys::keyring::{Found, now};
use crate::engine::limits::shared_turns::for_key;
use crate::http::App;
use crate::http::envelope::no_such_method;
use crate::http::peers::FORWARDED;
use crate::http::problem::{Kind, Problem};

/// The caller, for handlers whose permissions depend on more than the route.
#[derive(Clone, Debug)]
pub struct Caller(pub Access);

impl Caller {
    /// Fails if the caller lacks the permission for this action.
    pub fn needs(&self, action: Action) -> Result<(), Problem> {
        if self.0.may(action) { Ok(()) } else { Err(lacks(&self.0, action)) }
    }

    /// Returns the answer about a map that the key does not cover, whether or not it exists: what the key covers.
    fn lacks(&self, map: &MapId) -> ServiceError {
        let patterns = match &self.0 {
            Access::Open => Vec::new(),
            Access::Key(held) => held.key.properties.maps.iter().map(|maps| format!("`{maps}`")).collect(),
        };
        ServiceError::NotFound(format!(
            "this key covers the maps {}; {map} is none of them",
            patterns.join(", ")
        ))
    }

    /// Returns the patterns of the maps that the key covers; none where it covers every map.
    pub fn patterns(&self) -> Option<Vec<String>> {
        match &self.0 {
            Access::Key(held) if !held.key.properties.maps.contains(&MapPattern::every()) => {
                Some(held.key.properties.maps.iter().map(ToString::to_string).collect())
            }
            Access::Open | Access::Key(_) => None,
        }
    }

    /// Whether the caller's key covers this map.
    pub fn reaches(&self, map: &MapId) -> bool {
        match &self.0 {
            Access::Open => true,
            Access::Key(held) => held.key.properties.reaches(map),
        }
    }
}

impl<S: Send + Sync> FromRequestParts<S> for Caller {
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, _: &S) -> Result<Self, Problem> {
        let caller = parts.extensions.get::<Self>().cloned();
        caller.ok_or_else(|| Problem::internal("a route outside the access layer"))
    }
}

/// Middleware that enforces API keys.
pub async fn authorise(
    State(app): State<App>,
    request: Request,
    next: Next,
) -> axum::response::Result<Response> {
    let (mut parts, body) = request.into_parts();
    let caller = admitted(&app, &mut parts).await?;
    let key = caller.as_ref().and_then(|caller| caller.0.key());
    if let Some(caller) = caller {
        parts.extensions.insert(caller);
    }
    Ok(for_key(key, next.run(Request::from_parts(parts, body))).await)
}

/// Authorises a request, and returns its caller if the operation needs one.
async fn admitted(app: &App, parts: &mut Parts) -> axum::response::Result<Option<Caller>> {
    let route = parts.extensions.get::<MatchedPath>().map_or("", MatchedPath::as_str);
    let action = match app.permissions.find(&parts.method, route) {
        Err(allowed) => {
            let problem = no_such_method(parts.method.clone(), parts.uri.clone()).await;
            return Err(([(ALLOW, allowed)], problem).into());
        }
        Ok(Permission::Nothing) => return Ok(None),
        Ok(Permission::Undeclared) => {
            let detail =
                "the API document declares no permission for this operation, so it is denied to every caller";
            return Err(Problem::new(Kind::FORBIDDEN, detail).into());
        }
        Ok(Permission::AnyKey) => None,
        Ok(Permission::Action(action)) => Some(action),
    };
    // Nobody means it: a web page, or a proxy, has cut it off.
    if parts.headers.get_all(HOST).iter().any(HeaderValue::is_empty) {
        return Err(
            Problem::new(Kind::BAD_REQUEST, "`host` is empty: it names the server that is asked").into()
        );
    }
    let secret = secret(parts)?;
    let working = parts.extensions.get::<HeldPermit>().cloned().unwrap_or_default();
    let access =
        access(app, secret.as_deref(), &working).await.ok_or_else(|| unauthorized(secret.is_some()))?;
    match &access {
        // What another server sent on, that one has checked and counted.
        Access::Open if !is_from_peer(app, parts) => loopback_guard::check(parts)?,
        Access::Key(held) if !is_from_peer(app, parts) => {
            held.count(now().sec).map_err(Problem::too_many_requests)?;
        }
        Access::Open | Access::Key(_) => {}
    }
    if let Some(key) = access.key() {
        tracing::Span::current().record("key", key.public());
    }
    let caller = Caller(access);
    if let Some(map) = map_of(parts).await
        && !caller.reaches(&map)
    {
        return Err(Problem::from(caller.lacks(&map)).into());
    }
    if let Some(action) = action {
        caller.needs(action)?;
    }
    Ok(Some(caller))
}

/// Whether another server sent the request on.
fn is_from_peer(app: &App, parts: &Parts) -> bool {
    parts.headers.get(FORWARDED).is_some_and(|secret| app.service.is_from_peer(secret.as_bytes()))
}

/// Returns the access of a secret. An unknown secret waits for a database lookup without holding its permit.
async fn access(app: &App, secret: Option<&str>, working: &HeldPermit) -> Option<Access> {
    match app.service.keys().find(secret) {
        Found::Admitted(access) => Some(access),
        Found::Nobody => None,
        Found::Unknown => working.release_while(app.service.keys().look_for(secret?)).await,
    }
}

/// Returns the secret in `authorization: Bearer <secret>`.
fn secret(parts: &Parts) -> Result<Option<Arc<str>>, Problem> {
    let mut headers = parts.headers.get_all(AUTHORIZATION).iter();
    let Some(header) = headers.next() else { return Ok(None) };
    let secret = header.to_str().ok().and_then(|text| {
        let (scheme, secret) = text.split_once(' ')?;
        scheme.eq_ignore_ascii_case("bearer").then(|| secret.trim().into())
    });
    match (secret, headers.next()) {
        (Some(secret), None) => Ok(Some(secret)),
        _ => Err(unauthorized(true)),
    }
}

/// Returns the map of the route, decoded as its handler will decode it. An invalid id is not a map; the handler
/// reports it.
pub async fn map_of(parts: &mut Parts) -> Option<MapId> {
    let params = RawPathParams::from_request_parts(parts, &()).await.ok()?;
    params.iter().find(|(name, _)| *name == "map")?.1.parse().ok()
}

fn unauthorized(given: bool) -> Problem {
    let detail = if given {
        "the key is unknown, expired or revoked; send a valid one as `authorization: Bearer <secret>`"
    } else {
        "this server requires an API key: `authorization: Bearer <secret>`; `revisit keys create` creates one"
    };
    Problem::new(Kind::UNAUTHORIZED, detail)
}

fn lacks(access: &Access, action: Action) -> Problem {
    let may = match access {
        Access::Open => String::new(),
        Access::Key(held) => held.key.properties.actions.to_string(),
    };
    Problem::new(
        Kind::FORBIDDEN,
        format!("this operation requires a key with the action {}; this key has {may}", action.as_str()),
    )
}

#[cfg(test)]
mod tests {
    use axum::Router;
    use axum::body::Body;
    use axum::http::StatusCode;
    use axum::middleware::from_fn_with_state;
    use axum::routing::get;
    use serde_json::json;
    use tokio_util::sync::CancellationToken;
    use tower::ServiceExt as _;

    use axum::http::Method;
    use serde_json::Value;

    use super::*;
    use crate::api::verdict::LoopAnswer;
    use crate::config::limits::LimitArgs;
    use crate::engine::{Service, ServiceOptions};

    /// Sends a request to a router with the permissions of this document; its handlers allow everything.
    async fn asked(document: &Value, method: Method, path: &str) -> (StatusCode, String) {
        let folder = tempfile::tempdir().unwrap();
        let database = format!("sqlite://{}", folder.path().join("a.db").display());
        let service = Service::open(ServiceOptions::on(database, LoopAnswer::bytes)).await.unwrap();
        let limits = LimitArgs::of::<&str>(&[]).unwrap();
        let app = App::new(
            service.clone(),
            limits,
            serde_json::to_vec(document).unwrap(),
            CancellationToken::new(),
        );
        let done = async || "done";
        let router: Router = Router::new()
            .route("/v1/maps", get(done).delete(done))
            .route("/v1/forgotten", get(done))
            .route_layer(from_fn_with_state(app.unwrap(), authorise));
        let request = Request::builder().method(method).uri(path).header("host", "localhost");
        let response = router.oneshot(request.body(Body::empty()).unwrap()).await.unwrap();
        service.close().await;
        let allowed = response.headers().get(ALLOW).map(|allowed| allowed.to_str().unwrap().to_owned());
        (response.status(), allowed.unwrap_or_default())
    }

    #[tokio::test]
    async fn rejects_routes_that_the_document_lacks_and_every_route_of_an_empty_one() {
        let documented = || json!({"paths": {"/v1/maps": {"get": {"security": [{"key": ["read"]}]}}}});
        let silent = || json!({"paths": {"/v1/maps": {"get": {}, "delete": {"security": []}}}});
        let cases = [
            (documented(), Method::GET, "/v1/maps", StatusCode::OK, ""),
            (documented(), Method::HEAD, "/v1/maps", StatusCode::OK, ""),
            // Known to the router, not documented.
            (documented(), Method::DELETE, "/v1/maps", StatusCode::METHOD_NOT_ALLOWED, "GET,HEAD"),
            // Neither routed nor documented.
            (documented(), Method::PATCH, "/v1/maps", StatusCode::METHOD_NOT_ALLOWED, "GET,HEAD"),
            (documented(), Method::GET, "/v1/forgotten", StatusCode::FORBIDDEN, ""),
            (silent(), Method::GET, "/v1/maps", StatusCode::FORBIDDEN, ""),
            (silent(), Method::DELETE, "/v1/maps", StatusCode::FORBIDDEN, ""),
            (Value::Null, Method::GET, "/v1/maps", StatusCode::FORBIDDEN, ""),
            (json!({}), Method::DELETE, "/v1/maps", StatusCode::FORBIDDEN, ""),
        ];
        for (document, method, path, status, allowed) in cases {
            let answer = asked(&document, method.clone(), path).await;
            assert_eq!(answer, (status, allowed.to_owned()), "{method} {path} of {document}");
        }
    }
}
