//! Backup: a verified copy of the database, in the folder that the operator has named.

use revisit_core::domain::ids::BackupId;
use revisit_core::domain::report::BackupReport;
use revisit_core::domain::request::NewBackup;
use revisit_shapes::{answer, body};

use super::space::Time;

/// A backup to be taken.
#[body(same NewBackup)]
#[derive(Default)]
pub struct BackupBody {
    /// Its id; the server finds one if it is left out.
    #[id]
    pub id: Option<BackupId>,
}

/// A backup: whole, verified, and on disk.
#[answer(of = BackupReport)]
#[schema(as = Backup)]
pub struct BackupView {
    /// Its id; the file is called `ID.db`.
    pub id: String,
    /// The time of the request, since 1970: every write acknowledged before is in it.
    pub created: Time,
    /// Its size in bytes.
    pub bytes: u64,
    /// The SHA-256 of the file, in hexadecimal.
    pub sha256: String,
    /// The version of its schema.
    pub schema: i64,
    /// Maps in it.
    pub maps: u64,
    /// Keyframes in it.
    pub keyframes: u64,
    /// Anchors in it, merged ones too.
    pub anchors: u64,
    /// Older backups that were removed to make room for it; in the answer to the request that took it only.
    #[is(None)]
    pub removed: Option<Vec<String>>,
}

impl BackupView {
    /// Returns the answer to a backup that was taken, or found.
    pub fn taken(report: BackupReport, removed: &[BackupId]) -> Self {
        Self { removed: Some(removed.iter().map(ToString::to_string).collect()), ..report.into() }
    }
}
