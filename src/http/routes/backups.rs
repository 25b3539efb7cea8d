//! Backups: taken by the server itself, into the folder that its operator has named.

use axum::Json;
use axum::extract::State;
use axum::response::Response;

use crate::api::backup::{BackupBody, BackupView};
use crate::api::examples;
use crate::api::list::BackupList;
use crate::domain::request::NewBackup;
use crate::engine::Service;
use crate::http::answer::written;
use crate::http::error_responses::{OfBackup, OfList};
use crate::http::extract::body::Body;
use crate::http::extract::query::{Paging, Query};
use crate::http::problem::Problem;

/// Take a backup
///
/// A whole copy of the database as it is now, into the folder that `revisit serve --backups` names; verified and on disk
/// when it is answered. Verified is what `revisit restore` would accept; a copy of a database with faults is kept apart, as
/// `latest.damaged`, and answered 500 (`backup_not_verified`) with the first faults. The same id again is answered with the backup that is there. One at a time: another one
/// meanwhile is told to wait. The oldest beyond the number that is kept make room.
#[utoipa::path(
    post, path = "/v1/backups", tag = "service", security(("key" = ["admin"])),
    request_body(content = BackupBody, example = examples::backup_body),
    responses(
        (status = 201, description = "The backup is taken", body = BackupView, example = examples::backup_taken),
        (status = 200, description = "There was a backup of this id", body = BackupView,
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

/// List backups
///
/// The newest first, one part at a time.
#[utoipa::path(
    get, path = "/v1/backups", tag = "service", params(Paging), security(("key" = ["admin"])),
    responses(
        (status = 200, description = "One part of the list", body = BackupList, example = examples::backups), OfList
    )
)]
pub async fn list_backups(
    State(service): State<Service>,
    Query(page): Query<Paging>,
) -> Result<Json<BackupList>, Problem> {
    Ok(Json(service.list_backups(page.cursor.as_deref(), page.limit).await?.into()))
}
