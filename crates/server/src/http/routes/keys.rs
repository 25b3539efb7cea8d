//! Keys: create, list, revoke.

use axum::Json;
use axum::extract::State;
use axum::http::StatusCode;

use crate::api::examples;
use crate::api::key::{KeyBody, KeyView};
use crate::api::list::KeyList;
use crate::api::space::Time;
use crate::domain::key::{Key, KeyProperties};
use crate::engine::Service;
use crate::engine::keys::access::Access;
use crate::engine::keys::lockout::Lockout;
use crate::http::answer::Answer;
use crate::http::error_responses::{OfKey, OfList, OfRevocation, OfWrite};
use crate::http::extract::body::Body;
use crate::http::extract::path::KeyPath;
use crate::http::extract::query::{LastAdmin, Paging, Query};
use crate::http::guards::access::Caller;
use crate::http::problem::{Kind, Problem};

/// List keys
///
/// In order of creation, including revoked ones. Secrets are not stored.
#[utoipa::path(
    get, path = "/v1/keys", tag = "keys", params(Paging), security(("key" = ["admin"])),
    responses((status = 200, description = "One page of the list", body = KeyList, example = examples::keys), OfList)
)]
pub async fn list_keys(State(service): State<Service>, Query(page): Query<Paging>) -> Answer<KeyList> {
    let keys = service.keys().page(page.into())?;
    let uses = service.keys().uses();
    let view = |key: Key| {
        let last_used = uses
            .get(&key.seq)
            .filter(|uses| uses.requests > 0)
            .map(|uses| Time { sec: uses.last_s, nanosec: 0 });
        KeyView { last_used, ..KeyView::from(key) }
    };
    let items = keys.items.into_iter().map(view).collect();
    Ok(Json(KeyList { items, next_cursor: keys.next_cursor }))
}

/// Read the key that asks
///
/// What it may do, and with which maps. A server that requires no key answers 404.
#[utoipa::path(
    get, path = "/v1/keys/me", tag = "keys", security(("key" = [])),
    responses((status = 200, description = "The key", body = KeyView, example = examples::robots_key), OfKey)
)]
pub async fn get_own_key(caller: Caller) -> Answer<KeyView> {
    match caller.0 {
        Access::Key(held) => Ok(Json(held.key.clone().into())),
        Access::Open => {
            Err(Problem::new(Kind::NOT_FOUND, "this server requires no key: everything is permitted"))
        }
    }
}

/// Create a key
///
/// The response contains the secret, which is shown only once. From the first key on, every request needs a key,
/// including the viewer's. The first key must therefore be an administrator's: with `admin`, for every map, without an
/// expiry (else 409). `revisit keys create` creates keys directly in the database, to regain access.
#[utoipa::path(
    post, path = "/v1/keys", tag = "keys", security(("key" = ["admin"])),
    request_body(content = KeyBody, example = examples::key_body),
    responses(
        (status = 201, description = "The key, and its secret", body = KeyView, example = examples::made_key),
        OfWrite
    )
)]
pub async fn create_key(
    State(service): State<Service>,
    Body(properties): Body<KeyProperties>,
) -> Result<(StatusCode, Json<KeyView>), Problem> {
    let made = service.keys().create(properties, Lockout::Refused).await?;
    Ok((StatusCode::CREATED, Json(made.into())))
}

/// Revoke a key
///
/// The key is rejected from now on and stays in the list. Revoking it again changes nothing. The last administrator
/// key is revoked only with `last_admin=true` (else 409).
#[utoipa::path(
    delete, path = "/v1/keys/{id}", tag = "keys", params(KeyPath, LastAdmin), security(("key" = ["admin"])),
    responses((status = 204, description = "The key is revoked"), OfRevocation)
)]
pub async fn revoke_key(
    State(service): State<Service>,
    KeyPath { id }: KeyPath,
    Query(LastAdmin { last_admin }): Query<LastAdmin>,
) -> Result<StatusCode, Problem> {
    let lockout = if last_admin { Lockout::Meant } else { Lockout::Refused };
    service.keys().revoke(id.as_str(), lockout).await?;
    Ok(StatusCode::NO_CONTENT)
}
