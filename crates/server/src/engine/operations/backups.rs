//! Backups: taken and listed.

use std::fs;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::UNIX_EPOCH;

use crate::domain::ids::BackupId;
use crate::domain::report::{BackupReport, Page};
use crate::domain::request::PageRequest;
use crate::engine::backups::folder::{BackupFolder, BackupMade};
use crate::engine::service::Parts;
use crate::engine::tasks::{blocking, to_its_end};
use crate::engine::{Result, Service, ServiceError};

impl Service {
    /// Returns the same service, which keeps up to `kept` backups in a folder.
    pub fn with_backups(self, folder: PathBuf, kept: usize) -> Result<Self> {
        let backups = Some(Arc::new(BackupFolder::open(&folder, kept)?));
        Ok(Self(Arc::new(Parts { backups, ..Parts::clone(&self) })))
    }

    /// Takes a backup, or finds the one of this name. It is finished even if the client goes away.
    pub async fn back_up(&self, id: Option<BackupId>) -> Result<BackupMade> {
        let Some(files) = self.store.files().cloned() else {
            let detail =
                "the facts are in PostgreSQL: its own tools back them up, such as pg_dump or archived logs";
            return Err(ServiceError::Conflict { code: "no_backup_folder", detail: detail.to_owned() });
        };
        let Some(backups) = self.backups.clone() else {
            let detail = "the server was started without --backups DIR, and has no place to put one; \
                `revisit backup FILE` takes one beside it";
            return Err(ServiceError::Conflict { code: "no_backup_folder", detail: detail.to_owned() });
        };
        let permit = backups.enter()?;
        to_its_end(async move {
            let _permit = permit;
            backups.make(&files, id).await
        })
        .await?
    }

    /// Returns when the newest backup was taken, by this server or by `revisit backup`, in seconds since 1970; 0 without any.
    pub(in crate::engine) fn newest_backup_s(&self) -> u64 {
        let in_folder = self.backups.as_ref().map_or(0, |backups| backups.newest_s());
        let mark =
            self.store.files().and_then(|files| fs::metadata(files.backup_mark()).ok()?.modified().ok());
        let since = mark.and_then(|at| at.duration_since(UNIX_EPOCH).ok());
        in_folder.max(since.map_or(0, |since| since.as_secs()))
    }

    /// Deletes a backup.
    pub async fn delete_backup(&self, id: BackupId) -> Result<()> {
        let missing =
            || ServiceError::NotFound("there is no such backup; GET /v1/backups lists them".to_owned());
        let Some(backups) = self.backups.clone() else { return Err(missing()) };
        if blocking(move || backups.delete(&id)).await?? { Ok(()) } else { Err(missing()) }
    }

    /// Returns the backups, the newest first.
    pub async fn list_backups(&self, page: PageRequest) -> Result<Page<BackupReport>> {
        let Some(backups) = self.backups.clone() else {
            return Ok(Page { items: Vec::new(), next_cursor: None });
        };
        let mut items = blocking(move || backups.list()).await??;
        if let Some(cursor) = &page.cursor {
            let at = items.iter().position(|report| report.id.as_str() == *cursor);
            let at = at.ok_or_else(|| ServiceError::bad_cursor(cursor))?;
            items.drain(..=at);
        }
        Ok(Page::of(items, page.limit, |report| report.id.to_string()))
    }
}
