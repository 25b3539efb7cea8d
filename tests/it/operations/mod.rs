//! Operations: what those who run a server rely on.

mod backups;
mod bytes;
mod checks;
mod damaged;
mod logs;
mod metrics;
mod migrations;
mod mistakes;
mod served_backups;
mod slices;
mod stopping;
mod traces;

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use revisit::integrity::check::{IntegrityReport, check};
use revisit::store::files::paths::DatabaseFiles;
use serde_json::{Value, json};

/// How a subcommand ended.
#[derive(Debug)]
struct Ran {
    succeeded: bool,
    out: String,
    err: String,
}

/// A folder with the places of a database and of its backup.
struct Places {
    folder: tempfile::TempDir,
    database: PathBuf,
    backup: PathBuf,
}

impl Places {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let [database, backup] = ["revisit.db", "backup.db"].map(|name| folder.path().join(name));
        Self { folder, database, backup }
    }

    /// Runs `backup` or `restore` between the two.
    fn run(&self, command: &str, options: &[&str]) -> Ran {
        let (database, backup) = (url(&self.database), self.backup.display().to_string());
        revisit(&[&[command, "--database", &database], options, &[&backup]].concat())
    }
}

/// Runs a subcommand to its end.
fn revisit(arguments: &[&str]) -> Ran {
    let mut command = Command::new(env!("CARGO_BIN_EXE_revisit"));
    for (name, _) in std::env::vars().filter(|(name, _)| name.starts_with("REVISIT_")) {
        command.env_remove(name);
    }
    let output = command.args(arguments).stdin(Stdio::null()).output().unwrap();
    Ran {
        succeeded: output.status.success(),
        out: String::from_utf8(output.stdout).unwrap(),
        err: String::from_utf8(output.stderr).unwrap(),
    }
}

impl Ran {
    #[track_caller]
    fn well(self) -> String {
        assert!(self.succeeded, "{self:?}");
        self.out
    }

    /// It failed, and what it said contains this.
    #[track_caller]
    fn refused(self, because: &str) {
        assert!(!self.succeeded && self.err.contains(because), "{because}: {self:?}");
    }
}

fn url(database: &Path) -> String {
    format!("sqlite://{}", database.display())
}

pub(super) async fn checked(database: &Path) -> IntegrityReport {
    check(&DatabaseFiles::of_path(database)).await.unwrap()
}

/// The report of a check that finds no fault.
pub(super) async fn sound(database: &Path) -> IntegrityReport {
    let report = checked(database).await;
    let faults: Vec<String> = report.all_faults().collect();
    assert!(faults.is_empty(), "{}: {faults:?}", database.display());
    report
}

/// The names in a folder.
fn names(folder: &Path) -> BTreeSet<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
}

/// A keyframe with everything that a keyframe can bring.
fn keyframe(session: &str, number: u64) -> Value {
    let points: Vec<u64> = (number * 10..number * 10 + 30).collect();
    let positions: Vec<[f64; 3]> = points.iter().map(|point| [*point as f64 * 0.0625, 1.0, 2.0]).collect();
    json!({
        "session": session,
        "stamp": {"sec": 1000 + number, "nanosec": 5},
        "pose": {"translation": {"x": number as f64 * 0.5, "y": 0.0, "z": 0.0},
            "rotation": {"x": 0.5, "y": 0.5, "z": 0.5, "w": 0.5}},
        "camera": {"fx": 525.0, "fy": 525.0, "cx": 320.0, "cy": 240.0, "width": 640, "height": 480},
        "bow": {"words": [number, number + 1, 5000], "weights": [0.5, 0.25, 0.25]},
        "features": {"descriptor_bytes": 8, "descriptors": "AAECAwQFBgcICQoLDA0ODw==",
            "keypoints": [[100.5, 80.25], [310.0, 200.0, 2.0, 45.0]], "map_points": [points[0], -1]},
        "map_points": {"ids": points, "positions": positions},
        "observes": points,
        "detections": [
            {"class": "door_number", "confidence": 0.9, "box": [100.0, 120.0, 180.0, 160.0], "crop": "iVBORw0KGgo=",
             "map_points": [points[0], points[1]], "text": (900 + number).to_string()},
            {"class": "sign", "confidence": 0.5, "box": [1.0, 2.0, 30.0, 40.0], "position": [number, 0.5, 2.0], "text": "EXIT"}
        ]
    })
}
