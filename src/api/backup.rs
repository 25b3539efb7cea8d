//! Backup: a verified copy of the database, in the folder that the operator has named.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::decoding::read::{self, Decode, Node};
use super::space::Time;
use crate::domain::ids::BackupId;
use crate::domain::report::BackupReport;
use crate::domain::request::NewBackup;

/// A backup to be taken.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct BackupBody {
    /// Its id; the server finds one if it is left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(min_length = 1, max_length = 128, pattern = r"^(\.{0,2}[A-Za-z0-9_:-]|\.{3})[A-Za-z0-9._:-]*$")]
    pub id: Option<String>,
}

/// A backup: whole, verified, and on disk.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
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
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub removed: Option<Vec<String>>,
}

impl Decode for NewBackup {
    fn decode(node: &Node<'_>) -> Option<Self> {
        let body = node.object(&["id"])?;
        let id = body.optional("id", read::id)?;
        Some(Self { id })
    }
}

impl From<BackupReport> for BackupView {
    fn from(report: BackupReport) -> Self {
        Self {
            id: report.id.to_string(),
            created: report.created.into(),
            bytes: report.bytes,
            sha256: report.sha256,
            schema: report.schema,
            maps: report.maps,
            keyframes: report.keyframes,
            anchors: report.anchors,
            removed: None,
        }
    }
}

impl BackupView {
    /// Returns the answer to a backup that was taken, or found.
    pub fn taken(report: BackupReport, removed: &[BackupId]) -> Self {
        Self { removed: Some(removed.iter().map(ToString::to_string).collect()), ..report.into() }
    }
}
