//! Keys: made, listed, revoked.

use axum::Json;
use axum::extract::State;
use axum::http::StatusCode;

use crate::http::body::Body;
use crate::http::path::{InKey, KeyPath};
use crate::http::problem::Problem;
use crate::http::query::{Paging, Query};
use crate::http::refusals::{OfDelete, OfList, OfWrite};
use crate::model::key::KeyProperties;
use crate::service::Service;
use crate::wire::key::{self, KeyBody, KeyList, KeyView};

/// List keys
///
/// In order of creation, revoked ones among them; secrets are kept nowhere.
#[utoipa::path(
    get, path = "/v1/keys", tag = "keys", params(Paging), security(("key" = ["admin"])),
    responses((status = 200, description = "One part of the list", body = KeyList, example = key::example_list), OfList)
)]
pub async fn list_keys(
    State(service): State<Service>,
    Query(page): Query<Paging>,
) -> Result<Json<KeyList>, Problem> {
    let keys = service.keys().page(page.cursor.as_deref(), page.limit)?;
    let items = keys.items.into_iter().map(KeyView::from).collect();
    Ok(Json(KeyList { items, next_cursor: keys.next_cursor }))
}

/// Make a key
///
/// Its secret is told in this answer and never again. Once a database has had a key, nothing is answered without one.
#[utoipa::path(
    post, path = "/v1/keys", tag = "keys", security(("key" = ["admin"])),
    request_body(content = KeyBody, example = key::example_body),
    responses(
        (status = 201, description = "The key, and its secret", body = KeyView, example = key::example_made),
        OfWrite
    )
)]
pub async fn create_key(
    State(service): State<Service>,
    Body(properties): Body<KeyProperties>,
) -> Result<(StatusCode, Json<KeyView>), Problem> {
    let made = service.keys().create(properties).await?;
    Ok((StatusCode::CREATED, Json(made.into())))
}

/// Revoke a key
///
/// It is refused from now on, and stays in the list. Revoking it again changes nothing.
#[utoipa::path(
    delete, path = "/v1/keys/{id}", tag = "keys", params(KeyPath), security(("key" = ["admin"])),
    responses((status = 204, description = "The key is good no longer"), OfDelete)
)]
pub async fn revoke_key(State(service): State<Service>, InKey(id): InKey) -> Result<StatusCode, Problem> {
    service.keys().revoke(id.as_str()).await?;
    Ok(StatusCode::NO_CONTENT)
}
