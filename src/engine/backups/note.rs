//! The note beside a backup: a file that describes its content.

use serde::{Deserialize, Serialize};

use crate::domain::ids::BackupId;
use crate::domain::keyframe::Stamp;
use crate::domain::report::BackupReport;

/// The content of `ID.json`.
#[derive(Serialize, Deserialize)]
pub(super) struct Note {
    pub id: String,
    created_sec: i64,
    created_nanosec: u32,
    pub bytes: u64,
    sha256: String,
    schema: i64,
    maps: u64,
    keyframes: u64,
    anchors: u64,
}

impl Note {
    /// Returns the note of a backup.
    pub fn of(report: &BackupReport) -> Self {
        Self {
            id: report.id.to_string(),
            created_sec: report.created.sec,
            created_nanosec: report.created.nanosec,
            bytes: report.bytes,
            sha256: report.sha256.clone(),
            schema: report.schema,
            maps: report.maps,
            keyframes: report.keyframes,
            anchors: report.anchors,
        }
    }

    /// Returns what the note tells of a backup.
    pub fn report(self, id: BackupId) -> BackupReport {
        BackupReport {
            id,
            created: Stamp { sec: self.created_sec, nanosec: self.created_nanosec },
            bytes: self.bytes,
            sha256: self.sha256,
            schema: self.schema,
            maps: self.maps,
            keyframes: self.keyframes,
            anchors: self.anchors,
        }
    }
}
