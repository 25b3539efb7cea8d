//! Access: who asks, and may they? The layer around the routes of the API, which works on the route that was matched and
//! on its decoded parameters, never on the raw path.
//!
//! What an operation needs stands in the API document (`security`), and this layer reads it there: what is documented is
//! what is enforced. An operation that says nothing is refused to everybody, and so is a route that the document does not
//! have: nothing is let through because it was forgotten.

use std::collections::HashMap;
use std::sync::Arc;

use axum::extract::{FromRequestParts, MatchedPath, RawPathParams, Request, State};
use axum::http::Method;
use axum::http::header::{ALLOW, AUTHORIZATION};
use axum::http::request::Parts;
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use serde_json::Value;

use super::admission::HeldPermit;
use super::loopback_guard;
use crate::domain::ids::MapId;
use crate::domain::key::Action;
use crate::engine::ServiceError;
use crate::engine::keys::access::Access;
use crate::engine::keys::keyring::Found;
use crate::http::App;
use crate::http::envelope::no_such_method;
use crate::http::problem::{Kind, Problem};

/// The name of the security scheme in the API document.
pub const SCHEME: &str = "key";

/// What an operation asks of who calls it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Permission {
    /// Nothing: anybody may.
    Nothing,
    /// A key with this action.
    Action(Action),
    /// More than anybody has: the document does not say.
    Undeclared,
}

/// What each operation needs, by its method and the pattern of its route.
#[derive(Debug, Default)]
pub struct RoutePermissions(HashMap<(Method, String), Permission>);

impl RoutePermissions {
    /// Reads them from the API document.
    pub fn of(document: &Value) -> Self {
        let paths = document["paths"].as_object().into_iter().flatten();
        let operations = paths.flat_map(|(path, item)| {
            item.as_object().into_iter().flatten().filter_map(move |(method, operation)| {
                let method = Method::from_bytes(method.to_uppercase().as_bytes()).ok()?;
                Some(((method, path.clone()), need(operation)))
            })
        });
        Self(operations.collect())
    }

    /// Finds what a request needs; a method that its route does not document is no operation, whatever the router has.
    fn find(&self, method: &Method, route: &str) -> Result<Permission, Refusal> {
        // The router answers HEAD by what GET answers.
        let asked = if method == Method::HEAD { &Method::GET } else { method };
        if let Some(need) = self.0.get(&(asked.clone(), route.to_owned())) {
            return Ok(*need);
        }
        let mut allowed: Vec<&str> =
            self.0.keys().filter(|(_, path)| path == route).map(|(method, _)| method.as_str()).collect();
        if allowed.is_empty() {
            return Ok(Permission::Undeclared);
        }
        if allowed.contains(&"GET") {
            allowed.push("HEAD");
        }
        allowed.sort_unstable();
        Err(Refusal::NoSuchMethod(allowed.join(",")))
    }
}

fn need(operation: &Value) -> Permission {
    let Some(requirement) = operation["security"].get(0).and_then(Value::as_object) else {
        return Permission::Undeclared;
    };
    if requirement.is_empty() {
        return Permission::Nothing;
    }
    let action = requirement.get(SCHEME).and_then(|actions| Action::from_name(actions.get(0)?.as_str()?));
    action.map_or(Permission::Undeclared, Permission::Action)
}

/// Why a request goes no further.
enum Refusal {
    /// The path does not have the method; it has these.
    NoSuchMethod(String),
    /// Its caller may not.
    Problem(Problem),
}

impl From<Problem> for Refusal {
    fn from(problem: Problem) -> Self {
        Self::Problem(problem)
    }
}

/// Who called, for handlers whose needs depend on more than the route.
#[derive(Clone, Debug)]
pub struct Caller(pub Access);

impl Caller {
    /// May the caller do this, too?
    pub fn needs(&self, action: Action) -> Result<(), Problem> {
        if self.0.may(action) { Ok(()) } else { Err(lacks(&self.0, action)) }
    }

    /// Does this map exist for the caller?
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
        caller.ok_or_else(|| Problem::internal("a route outside the layer of access"))
    }
}

/// The layer.
pub async fn authorise(State(app): State<App>, request: Request, next: Next) -> Response {
    let (mut parts, body) = request.into_parts();
    match admitted(&app, &mut parts).await {
        Ok(caller) => {
            if let Some(caller) = caller {
                parts.extensions.insert(caller);
            }
            next.run(Request::from_parts(parts, body)).await
        }
        Err(Refusal::Problem(problem)) => problem.into_response(),
        Err(Refusal::NoSuchMethod(allowed)) => {
            let problem = no_such_method(parts.method, parts.uri).await;
            ([(ALLOW, allowed)], problem).into_response()
        }
    }
}

/// Who calls, if the operation wants to know.
async fn admitted(app: &App, parts: &mut Parts) -> Result<Option<Caller>, Refusal> {
    let route = parts.extensions.get::<MatchedPath>().map_or("", MatchedPath::as_str);
    let action = match app.needs.find(&parts.method, route)? {
        Permission::Nothing => return Ok(None),
        Permission::Undeclared => {
            let detail = "the API document does not say who may do this, so it is refused to everybody";
            return Err(Problem::new(Kind::FORBIDDEN, detail).into());
        }
        Permission::Action(action) => action,
    };
    let secret = secret(parts)?;
    let working = parts.extensions.get::<HeldPermit>().cloned().unwrap_or_default();
    let access =
        access(app, secret.as_deref(), &working).await.ok_or_else(|| unauthorized(secret.is_some()))?;
    match &access {
        Access::Open => loopback_guard::check(parts)?,
        Access::Key(held) => held.count().map_err(Problem::too_many_requests)?,
    }
    if let Some(key) = access.key() {
        tracing::Span::current().record("key", key.public());
    }
    let caller = Caller(access);
    if let Some(map) = map_of(parts).await
        && !caller.reaches(&map)
    {
        // Just what a key that reaches every map hears of a map that is not there.
        return Err(Problem::from(ServiceError::no_map(&map)).into());
    }
    caller.needs(action)?;
    Ok(Some(caller))
}

/// Who sends this secret? Strangers wait for a look at the disk without taking the place of those who are known.
async fn access(app: &App, secret: Option<&str>, working: &HeldPermit) -> Option<Access> {
    match app.service.keys().find(secret) {
        Found::Admitted(access) => Some(access),
        Found::Nobody => None,
        Found::Unknown => working.release_while(app.service.keys().look_for(secret?)).await,
    }
}

/// The secret in `authorization: Bearer <secret>`.
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

/// The map that the route names, decoded as its handler will decode it. One that is no id names no map; the handler says so.
async fn map_of(parts: &mut Parts) -> Option<MapId> {
    let params = RawPathParams::from_request_parts(parts, &()).await.ok()?;
    params.iter().find(|(name, _)| *name == "map")?.1.parse().ok()
}

fn unauthorized(given: bool) -> Problem {
    let detail = if given {
        "this key is not known, has expired, or was revoked; it is sent as `authorization: Bearer <secret>`"
    } else {
        "this server wants an API key: `authorization: Bearer <secret>`; `revisit keys create` makes one"
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
        format!("this takes a key that may {}; this one may {may}", action.as_str()),
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

    use super::*;
    use crate::api::verdict::LoopAnswer;
    use crate::config::limits::LimitArgs;
    use crate::engine::{Service, ServiceOptions};

    /// Asks a router with these needs; its handlers do all that they are asked.
    async fn asked(needs: RoutePermissions, method: Method, path: &str) -> (StatusCode, String) {
        let folder = tempfile::tempdir().unwrap();
        let database = format!("sqlite://{}", folder.path().join("a.db").display());
        let service = Service::open(ServiceOptions::on(database, LoopAnswer::bytes)).await.unwrap();
        let limits = LimitArgs::of::<&str>(&[]).unwrap();
        let app = App::new(service.clone(), limits, CancellationToken::new()).unwrap().with_needs(needs);
        let done = async || "done";
        let router: Router = Router::new()
            .route("/v1/maps", get(done).delete(done))
            .route("/v1/forgotten", get(done))
            .route_layer(from_fn_with_state(app, authorise));
        let request = Request::builder().method(method).uri(path).header("host", "localhost");
        let response = router.oneshot(request.body(Body::empty()).unwrap()).await.unwrap();
        service.close().await;
        let allowed = response.headers().get(ALLOW).map(|allowed| allowed.to_str().unwrap().to_owned());
        (response.status(), allowed.unwrap_or_default())
    }

    #[tokio::test]
    async fn what_the_document_does_not_have_is_refused_and_a_document_that_is_empty_has_nothing() {
        let documented = || json!({"paths": {"/v1/maps": {"get": {"security": [{"key": ["read"]}]}}}});
        let silent = || json!({"paths": {"/v1/maps": {"get": {}, "delete": {"security": []}}}});
        let cases = [
            (documented(), Method::GET, "/v1/maps", StatusCode::OK, ""),
            (documented(), Method::HEAD, "/v1/maps", StatusCode::OK, ""),
            // The router has it, the document does not.
            (documented(), Method::DELETE, "/v1/maps", StatusCode::METHOD_NOT_ALLOWED, "GET,HEAD"),
            // Neither has it.
            (documented(), Method::PATCH, "/v1/maps", StatusCode::METHOD_NOT_ALLOWED, "GET,HEAD"),
            (documented(), Method::GET, "/v1/forgotten", StatusCode::FORBIDDEN, ""),
            (silent(), Method::GET, "/v1/maps", StatusCode::FORBIDDEN, ""),
            (silent(), Method::DELETE, "/v1/maps", StatusCode::FORBIDDEN, ""),
            (Value::Null, Method::GET, "/v1/maps", StatusCode::FORBIDDEN, ""),
            (json!({}), Method::DELETE, "/v1/maps", StatusCode::FORBIDDEN, ""),
        ];
        for (document, method, path, status, allowed) in cases {
            let answer = asked(RoutePermissions::of(&document), method.clone(), path).await;
            assert_eq!(answer, (status, allowed.to_owned()), "{method} {path} of {document}");
        }
    }
}
