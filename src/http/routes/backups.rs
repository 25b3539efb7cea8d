//! Backups: created by the server, in the folder that its operator configured.

use axum::Json;
use axum::extract::State;
use axum::http::StatusCode;
use axum::response::Response;

use crate::api::backup::{BackupBody, BackupView};
use crate::api::examples;
use crate::api::list::BackupList;
use crate::domain::request::NewBackup;
use crate::engine::Service;
use crate::http::answer::written;
use crate::http::error_responses::{OfBackup, OfDelete, OfList};
use crate::http::extract::body::Body;
use crate::http::extract::path::BackupPath;
use crate::http::extract::query::{Paging, Query};
use crate::http::problem::Problem;

/// Take a backup
///
/// Creates a complete copy of the database in the folder given by `revisit serve --backups`. It is verified and on
/// disk when the response is sent. A verified backup is one that `revisit restore` accepts. If the database has
/// faults, the copy is kept as `latest.damaged`, and the response is 500 (`backup_not_verified`) with the first
/// faults. An existing id returns the existing backup. Only one backup runs at a time; another request receives 503.
/// The oldest backups beyond the configured number are deleted.
#[utoipa::path(
    post, path = "/v1/backups", tag = "service", security(("key" = ["admin"])),
    request_body(content = BackupBody, example = examples::backup_body),
    responses(
        (status = 201, description = "The backup was created", body = BackupView, example = examples::backup_taken),
        (status = 200, description = "A backup of this id already existed", body = BackupView,
            headers(("idempotent-replayed" = String, description = "`true`")), example = examples::backup_taken),
        OfBackup
    )
)]
pub async fn take_backup(
    State(service): State<Service>,
    Body(new): Body<NewBackup>,
) -> Result<Response, Problem> {
    let made = service.back_up(new.id).await?;
    Ok(written(made.created, BackupView::taken(made.report, &made.removed)))
}

/// Delete a backup
///
/// Its two files are removed from the folder given by `revisit serve --backups`.
#[utoipa::path(
    delete, path = "/v1/backups/{id}", tag = "service", params(BackupPath), security(("key" = ["admin"])),
    responses((status = 204, description = "The backup is deleted"), OfDelete)
)]
pub async fn delete_backup(
    State(service): State<Service>,
    BackupPath { id }: BackupPath,
) -> Result<StatusCode, Problem> {
    service.delete_backup(id).await?;
    Ok(StatusCode::NO_CONTENT)
}

/// List backups
///
/// Newest first, paged.
#[utoipa::path(
    get, path = "/v1/backups", tag = "service", params(Paging), security(("key" = ["admin"])),
    responses(
        (status = 200, description = "One page of the list", body = BackupList, example = examples::backups), OfList
    )
)]
pub async fn list_backups(
    State(service): State<Service>,
    Query(page): Query<Paging>,
) -> Result<Json<BackupList>, Problem> {
    Ok(Json(service.list_backups(page.into()).await?.into()))
}
