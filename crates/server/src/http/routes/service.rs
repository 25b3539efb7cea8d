//! Service: the state of the server and its backups, for operators.

use axum::Json;
use axum::extract::State;
use axum::http::StatusCode;
use axum::http::header::CONTENT_TYPE;
use axum::response::{IntoResponse, Response};

use crate::api::backup::{BackupBody, BackupView};
use crate::api::examples;
use crate::api::list::BackupList;
use crate::api::service::{Health, Version};
use crate::config::build;
use crate::domain::request::NewBackup;
use crate::engine::Service;
use crate::http::App;
use crate::http::answer::{Answer, json_bytes, written};
use crate::http::error_responses::{OfBackup, OfDelete, OfList, OfNobody, OfReadiness};
use crate::http::extract::body::Body;
use crate::http::extract::path::BackupPath;
use crate::http::extract::query::{Paging, Query};
use crate::http::metrics::counters::Metrics;
use crate::http::problem::{Kind, Problem};
use crate::store::Disk;

/// Check liveness
///
/// Returns 200 while the process is alive.
#[utoipa::path(
    get, path = "/healthz", tag = "service", security(()),
    responses((status = 200, description = "It is", body = Health, example = examples::health), OfNobody)
)]
pub async fn healthz() -> Json<Health> {
    Json(Health::of("alive"))
}

/// Check readiness for requests
///
/// Returns 200 once the database is open, 503 after shutdown begins. Maps are loaded on first use. A server whose disk refuses
/// writes still answers questions: it returns 200 with `degraded`, and why.
#[utoipa::path(
    get, path = "/readyz", tag = "service", security(()),
    responses((status = 200, description = "It is ready", body = Health, example = examples::ready), OfReadiness)
)]
pub async fn readyz(State(app): State<App>) -> Answer<Health> {
    if app.stopping.is_cancelled() {
        return Err(Problem::new(Kind::UNAVAILABLE, "the server is stopping"));
    }
    app.service.ready()?;
    Ok(Json(match app.service.disk() {
        Disk::Well => Health::of("ready"),
        Disk::Full => {
            Health::degraded("the disk is full: writes are refused, reads and deletes are answered")
        }
        Disk::Failing => Health::degraded("the disk or the database fails: writes are refused"),
    }))
}

/// Read the server's version
///
/// Includes the version of the embedded SQLite.
#[utoipa::path(
    get, path = "/version", tag = "service", security(()),
    responses((status = 200, description = "The version", body = Version, example = examples::version), OfReadiness)
)]
pub async fn get_version(State(service): State<Service>) -> Answer<Version> {
    Ok(Json(Version {
        name: build::NAME.to_owned(),
        version: build::VERSION.to_owned(),
        sqlite: build::SQLITE.to_owned(),
        postgres: service.postgres_version().await?,
        vocabulary: service.vocabulary().map(|(name, _)| name.to_owned()),
    }))
}

/// Read the metrics
///
/// In the OpenMetrics format, for Prometheus.
#[utoipa::path(
    get, path = "/metrics", tag = "service", security(()),
    responses(
        (status = 200, description = "The metrics", body = String, content_type = "application/openmetrics-text",
            example = "# EOF\n"),
        OfNobody
    )
)]
pub async fn get_metrics(State(app): State<App>) -> impl IntoResponse {
    app.metrics.open_now(app.slots.open(), app.service.pressure().working());
    // Nothing here waits for the database or another request, because operators need metrics most under load.
    let uses = app.service.keys().uses().into_iter();
    let requests: Vec<_> = uses.map(|(seq, uses)| (seq, uses.requests)).collect();
    ([(CONTENT_TYPE, Metrics::MEDIA_TYPE)], app.metrics.text(&app.service.stats(), &requests))
}

/// Read this document
///
/// As JSON; `revisit openapi` prints it too.
#[utoipa::path(
    get, path = "/openapi.json", tag = "service", security(()),
    responses(
        (status = 200, description = "The document", body = serde_json::Value, content_type = "application/json",
            example = examples::document),
        OfReadiness
    )
)]
pub async fn get_document(State(app): State<App>) -> Response {
    json_bytes(app.document.clone())
}

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
pub async fn list_backups(State(service): State<Service>, Query(page): Query<Paging>) -> Answer<BackupList> {
    Ok(Json(service.list_backups(page.into()).await?.into()))
}
