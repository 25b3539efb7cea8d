//! The folder of backups.
//!
//! A backup is two files: `ID.db`, and beside it `ID.json`, which tells what is in it. Whoever asks names an id and never a
//! path. A retry under the same id finds the backup that is there, as every write by id does.

use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use tokio::runtime::Handle;
use tokio::sync::{OwnedSemaphorePermit, Semaphore};

use crate::domain::ids::BackupId;
use crate::domain::keyframe::Stamp;
use crate::domain::report::BackupReport;
use crate::engine::error::{Result, ServiceError};
use crate::engine::keys::keyring::now;
use crate::engine::tasks::blocking;
use crate::integrity::backup::{Copied, Copy, PARTIAL, sync_folder};
use crate::store::StoreError;
use crate::store::files::paths::DatabaseFiles;

/// When to ask again while another backup is being taken, in seconds.
const BUSY_RETRY_S: u32 = 5;

/// An unfinished copy that nobody has written to for so long belongs to a process that is gone.
const ABANDONED: Duration = Duration::from_hours(1);

/// The name of the newest copy that has faults; no id leads to it.
const LATEST_DAMAGED: &str = "latest.damaged";

/// The most faults of a copy that are told and logged; `revisit check` lists them all.
const FAULTS_TOLD: usize = 5;

/// The folder of backups.
#[derive(Debug)]
pub(in crate::engine) struct BackupFolder {
    folder: PathBuf,
    kept: usize,
    one_at_a_time: Arc<Semaphore>,
    /// When the newest was taken, in seconds since 1970; 0 without any.
    newest_s: AtomicU64,
}

/// A backup that was asked for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BackupMade {
    /// False if it had been made before.
    pub created: bool,
    /// The backup.
    pub report: BackupReport,
    /// Older ones that made room for it.
    pub removed: Vec<BackupId>,
}

impl BackupFolder {
    /// Opens a folder that keeps up to `kept` backups; makes it if it is not there.
    pub fn open(folder: &Path, kept: usize) -> Result<Self> {
        let failed = |error: std::io::Error| ServiceError::Internal(format!("{}: {error}", folder.display()));
        fs::create_dir_all(folder).map_err(failed)?;
        let backups = Self {
            kept: kept.max(1),
            one_at_a_time: Arc::new(Semaphore::new(1)),
            newest_s: AtomicU64::new(0),
            folder: folder.canonicalize().map_err(failed)?,
        };
        backups.sweep();
        backups.remember_newest(&backups.list()?);
        Ok(backups)
    }

    /// Admits a backup to be taken; refuses it while another one is.
    pub fn enter(&self) -> Result<OwnedSemaphorePermit> {
        self.one_at_a_time.clone().try_acquire_owned().map_err(|_| {
            let detail = "another backup is being taken".to_owned();
            ServiceError::Unavailable { detail, retry_after_s: BUSY_RETRY_S }
        })
    }

    /// Returns when the newest was taken, in seconds since 1970; 0 without any.
    pub fn newest_s(&self) -> u64 {
        self.newest_s.load(Ordering::Relaxed)
    }

    /// Takes a backup, or finds the one of this name; older ones make room for it.
    pub async fn make(self: Arc<Self>, files: &DatabaseFiles, id: Option<BackupId>) -> Result<BackupMade> {
        let created = now();
        let id = match id {
            Some(id) => id,
            None => self.free_id(created)?,
        };
        if let Some(report) = self.find(&id) {
            return Ok(BackupMade { created: false, report, removed: Vec::new() });
        }
        if self.database(&id).exists() {
            let detail =
                format!("a file {id}.db that is no backup of this server lies in the folder of backups");
            return Err(ServiceError::Conflict { code: "backup_exists", detail });
        }
        let copy = self.copied(files).await?;
        if !copy.faults().is_empty() {
            let keep = move || self.keep_damaged(&id, copy);
            return blocking(keep).await?;
        }
        let place = move || {
            let report = report(id, created, &copy.copied);
            self.write_note(&report)?;
            copy.place(&self.database(&report.id), false)?;
            let all = self.list()?;
            self.remember_newest(&all);
            let removed = self.remove_all_but_the_newest(all)?;
            tracing::info!(backup = %report.id, bytes = report.bytes, "a backup was taken");
            Ok(BackupMade { created: true, report, removed })
        };
        blocking(place).await?
    }

    /// Copies and checks off the async threads: the check builds the index of every map.
    async fn copied(&self, files: &DatabaseFiles) -> Result<Copy> {
        let (files, folder, runtime) = (files.clone(), self.folder.clone(), Handle::current());
        let copy = move || runtime.block_on(Copy::of(&files, &folder));
        Ok(blocking(copy).await??)
    }

    /// Keeps a copy that has faults, in place of an earlier one of the kind, where nobody takes it for a backup.
    fn keep_damaged(&self, id: &BackupId, copy: Copy) -> Result<BackupMade> {
        let faults = copy.faults().to_vec();
        copy.place(&self.folder.join(LATEST_DAMAGED), true)?;
        for fault in faults.iter().take(FAULTS_TOLD) {
            tracing::error!(backup = %id, fault, "a backup is not verified");
        }
        let (count, listed) = (faults.len(), faults[..faults.len().min(FAULTS_TOLD)].join("; "));
        Err(ServiceError::NotVerified(format!(
            "the database has faults ({count}), and so has the copy, which is no backup and is kept as {LATEST_DAMAGED} in \
             the folder of backups; earlier backups stay: {listed}"
        )))
    }

    fn database(&self, id: &BackupId) -> PathBuf {
        self.folder.join(format!("{id}.db"))
    }

    fn note(&self, id: &BackupId) -> PathBuf {
        self.folder.join(format!("{id}.json"))
    }

    fn free_id(&self, created: Stamp) -> Result<BackupId> {
        let names = (0_u32..).map(|again| match again {
            0 => format!("b-{}", created.sec),
            again => format!("b-{}-{again}", created.sec),
        });
        let free = |id: &BackupId| !self.database(id).exists();
        let mut ids = names.filter_map(|name| name.parse::<BackupId>().ok());
        ids.find(free).ok_or_else(|| ServiceError::Internal("no name for a backup is free".to_owned()))
    }

    /// Writes the note, before the copy has its name: a note without a backup is passed over, a backup without a note would be.
    fn write_note(&self, report: &BackupReport) -> Result<()> {
        let note = self.note(&report.id);
        let write = || -> std::io::Result<()> {
            let mut file = tempfile::Builder::new().suffix(PARTIAL).tempfile_in(&self.folder)?;
            file.write_all(&serde_json::to_vec(report).unwrap_or_default())?;
            file.as_file().sync_all()?;
            file.persist(&note)?;
            Ok(())
        };
        write().map_err(|error| StoreError::file(&note, &error).into())
    }

    /// Returns a backup whose two files are there.
    fn find(&self, id: &BackupId) -> Option<BackupReport> {
        let noted: BackupReport = serde_json::from_slice(&fs::read(self.note(id)).ok()?).ok()?;
        let is_there = fs::metadata(self.database(id)).is_ok_and(|file| file.len() == noted.bytes);
        (is_there && noted.id == *id).then_some(noted)
    }

    /// Returns the backups, the newest first.
    pub fn list(&self) -> Result<Vec<BackupReport>> {
        let entries = fs::read_dir(&self.folder).map_err(|error| StoreError::file(&self.folder, &error))?;
        let names = entries.filter_map(|entry| entry.ok()?.file_name().into_string().ok());
        let ids = names.filter_map(|name| name.strip_suffix(".json")?.parse::<BackupId>().ok());
        let mut reports: Vec<BackupReport> = ids.filter_map(|id| self.find(&id)).collect();
        reports.sort_by(|a, b| (b.created, &b.id).cmp(&(a.created, &a.id)));
        Ok(reports)
    }

    fn remember_newest(&self, newest_first: &[BackupReport]) {
        let newest = newest_first.first().map_or(0, |report| report.created.sec as u64);
        self.newest_s.store(newest, Ordering::Relaxed);
    }

    fn remove_all_but_the_newest(&self, newest_first: Vec<BackupReport>) -> Result<Vec<BackupId>> {
        let mut removed = Vec::new();
        for report in newest_first.into_iter().skip(self.kept) {
            self.remove(&report.id)?;
            removed.push(report.id);
        }
        sync_folder(&self.folder)?;
        Ok(removed)
    }

    /// Deletes a backup; false if there is none of this name.
    pub fn delete(&self, id: &BackupId) -> Result<bool> {
        if self.find(id).is_none() {
            return Ok(false);
        }
        self.remove(id)?;
        sync_folder(&self.folder)?;
        self.remember_newest(&self.list()?);
        Ok(true)
    }

    fn remove(&self, id: &BackupId) -> Result<(), StoreError> {
        for file in [self.database(id), self.note(id)] {
            fs::remove_file(&file).map_err(|error| StoreError::file(&file, &error))?;
        }
        Ok(())
    }

    /// Removes copies that a crash has left unfinished.
    fn sweep(&self) {
        let is_abandoned = |path: &Path| {
            let touched = fs::metadata(path).and_then(|file| file.modified()).ok();
            touched.and_then(|at| at.elapsed().ok()).is_some_and(|since| since > ABANDONED)
        };
        for entry in fs::read_dir(&self.folder).into_iter().flatten().flatten() {
            let path = entry.path();
            if entry.file_name().to_string_lossy().ends_with(PARTIAL) && is_abandoned(&path) {
                tracing::info!(path = %path.display(), "removing a backup that was not finished");
                let _ = fs::remove_file(path);
            }
        }
    }
}

fn report(id: BackupId, created: Stamp, copied: &Copied) -> BackupReport {
    let holds = copied.holds;
    BackupReport {
        id,
        created,
        bytes: copied.bytes,
        sha256: copied.sha256.clone(),
        schema: holds.schema,
        maps: holds.maps,
        keyframes: holds.keyframes,
        anchors: holds.anchors,
    }
}
