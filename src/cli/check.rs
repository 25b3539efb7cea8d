//! `revisit check`: verifies the integrity of a database or a backup.

use std::path::PathBuf;

use clap::Args;
use serde_json::json;

use super::failure::Failure;
use super::output::write_out;
use crate::domain::counted::counted;
use crate::integrity::check::{IntegrityReport, check};
use crate::integrity::map_check::MapCheck;
use crate::store::Holdings;
use crate::store::files::paths::DatabaseFiles;

/// Maximum faults listed as text; `--json` has them all.
const LISTED: usize = 20;

/// Check the integrity of a database and of every map in it.
///
/// Works on a database in use and on backups, and is read-only. Exits with 1 on any fault: torn pages, dangling
/// references, values that do not decode, numbers that are missing or would be assigned twice, and maps whose index
/// depends on the order of its facts. It cannot detect a value replaced by another valid one.
#[derive(Args, Debug)]
pub struct CheckArgs {
    /// A file to check instead of the database, such as a backup
    file: Option<PathBuf>,
    /// The database, or a backup as sqlite://FILE
    #[arg(long, env = "REVISIT_DATABASE", value_name = "URL", default_value = "sqlite://revisit.db")]
    database: String,
    /// Print one JSON object
    #[arg(long, env = "REVISIT_JSON")]
    json: bool,
}

/// Runs `check`.
pub async fn run(args: CheckArgs) -> Result<(), Failure> {
    let files = match args.file {
        Some(file) => DatabaseFiles::of_path(&file),
        None => DatabaseFiles::of_url(&args.database)?,
    };
    let checked = check(&files).await?;
    let faults: Vec<String> = checked.all_faults().collect();
    let json = || format!("{}\n", as_json(&checked, &faults));
    write_out(&if args.json { json() } else { as_text(&checked, &faults) })?;
    match faults.len() {
        0 => Ok(()),
        count => Err(format!("{}: {}", files.database().display(), counted(count, "fault")).into()),
    }
}

fn as_text(checked: &IntegrityReport, faults: &[String]) -> String {
    let mut lines: Vec<String> = checked.maps.iter().map(map_line).collect();
    lines.extend(checked.holds.as_ref().map(contents));
    lines.extend(checked.notes.iter().map(|note| format!("note: {note}")));
    lines.extend(faults.iter().take(LISTED).map(|fault| format!("fault: {fault}")));
    if faults.len() > LISTED {
        lines.push(format!("and {}; --json lists them", counted(faults.len() - LISTED, "more fault")));
    }
    if faults.is_empty() {
        lines.push("sound".to_owned());
    }
    lines.into_iter().map(|line| line + "\n").collect()
}

/// Returns what a database or a backup has in it, on one line.
pub(super) fn contents(holds: &Holdings) -> String {
    let maps = counted(holds.maps, "map");
    let (keyframes, anchors) = (counted(holds.keyframes, "keyframe"), counted(holds.anchors, "anchor"));
    format!("{maps}, {keyframes}, {anchors}, schema {}", holds.schema)
}

fn map_line(map: &MapCheck) -> String {
    let verdict = if map.faults.is_empty() { "sound".to_owned() } else { counted(map.faults.len(), "fault") };
    format!(
        "map {}: {verdict}; version {}, {}, {}, {}, {}",
        map.id,
        map.version,
        counted(map.keyframes, "keyframe"),
        counted(map.anchors, "anchor"),
        counted(map.loops, "loop"),
        counted(map.events, "event"),
    )
}

fn as_json(checked: &IntegrityReport, faults: &[String]) -> serde_json::Value {
    json!({
        "sound": faults.is_empty(),
        "schema": checked.holds.map(|holds| holds.schema),
        "maps": checked.maps,
        "faults": faults,
        "notes": checked.notes,
    })
}
