//! `revisit backup`, `revisit restore`: a verified copy of the database, and back.

use std::path::PathBuf;

use clap::Args;

use super::failure::Failure;
use super::output::write_out;
use crate::domain::counted::counted;
use crate::integrity::backup::{Copied, Copy, folder_of, regular_or_free};
use crate::integrity::restore::{Allowed, restore};
use crate::store::files::paths::DatabaseFiles;

/// What is added to the name of a copy that has faults.
const DAMAGED: &str = ".damaged";

/// The most faults that are listed; `revisit check --json` has them all.
const LISTED: usize = 20;

/// Copy the database into a file, also while a server runs.
///
/// The copy is what the database held at one moment: everything acknowledged before the backup began is in it. It is
/// verified by what `check` looks at, and on disk, when the command ends. A copy that `check` finds faults in is kept as
/// FILE.damaged, an earlier backup in FILE stays, and the command ends with 1. It needs as much room as the data, and the server's log grows meanwhile by
/// what is written.
#[derive(Args, Debug)]
pub struct BackupArgs {
    /// The file to write
    file: PathBuf,
    /// The database
    #[arg(long, env = "REVISIT_DATABASE", value_name = "URL", default_value = "sqlite://revisit.db")]
    database: String,
    /// Replace the file if it is there
    #[arg(long, env = "REVISIT_FORCE")]
    force: bool,
}

/// Make a backup the database; no server may have that open.
///
/// The backup is checked first, by what `check` looks at. Nothing is overwritten: the database that is there keeps lying beside, under another
/// name. Run it as the user that the server runs as.
#[derive(Args, Debug)]
pub struct RestoreArgs {
    /// The backup
    file: PathBuf,
    /// The database to put in its place
    #[arg(long, env = "REVISIT_DATABASE", value_name = "URL", default_value = "sqlite://revisit.db")]
    database: String,
    /// Do so though there is a database: it is kept under another name
    #[arg(long, env = "REVISIT_FORCE")]
    force: bool,
    /// Do so though the backup has faults: sound maps are served, a damaged one answers 500
    #[arg(long, env = "REVISIT_DAMAGED")]
    damaged: bool,
}

/// Runs `backup`.
pub async fn run(args: BackupArgs) -> Result<(), Failure> {
    if args.file.exists() && !args.force {
        return Err(format!("{} exists; --force replaces it", args.file.display()).into());
    }
    let database = DatabaseFiles::of_url(&args.database)?;
    if !database.exist() {
        return Err(format!("there is no database {}", database.database().display()).into());
    }
    if database.hold(&args.file) {
        return Err("the file is the database itself, or a part of it".into());
    }
    regular_or_free(&args.file)?;
    let copy = Copy::from_outside(&database, folder_of(&args.file)).await?;
    if !copy.faults().is_empty() {
        return Err(keep_damaged(copy, &args)?.into());
    }
    let copied = copy.place(&args.file, args.force)?;
    let (file, holds, verified) = (args.file.display(), report(&copied), verified(&copied));
    Ok(write_out(&format!(
        "{file}: {holds}; {} bytes, {verified}, sha256 {}\n",
        copied.bytes, copied.sha256
    ))?)
}

/// Keeps a copy that has faults, under a name that nobody takes for a backup, and returns what there is to say of it.
fn keep_damaged(copy: Copy, args: &BackupArgs) -> Result<String, Failure> {
    let count = copy.faults().len();
    let listed = copy.faults()[..count.min(LISTED)].join("\n  ");
    let mut name = args.file.clone().into_os_string();
    name.push(DAMAGED);
    let damaged = PathBuf::from(name);
    let copied = copy.place(&damaged, args.force)?;
    Ok(format!(
        "not verified: the database has faults ({count}), and so has the copy, which is kept as {} ({} bytes, sha256 {}); \
         {} is as it was. `revisit restore` takes such a copy with --damaged only.\n  {listed}",
        damaged.display(),
        copied.bytes,
        copied.sha256,
        args.file.display(),
    ))
}

/// Runs `restore`.
pub async fn run_restore(args: RestoreArgs) -> Result<(), Failure> {
    let target = DatabaseFiles::of_url(&args.database)?;
    let backup = DatabaseFiles::of_path(&args.file);
    let restored = restore(&backup, &target, Allowed { replace: args.force, faults: args.damaged }).await?;
    let holds = report(&restored.copied);
    // Its sum is not told: SQLite has written it anew, and it differs from the backup's.
    let verified = match restored.faults.len() {
        0 => verified(&restored.copied).to_owned(),
        count => format!("not verified, faults: {count}"),
    };
    write_out(&format!("{}: {holds}, {verified}\n", target.database().display()))?;
    for fault in restored.faults.iter().take(LISTED) {
        write_out(&format!("fault: {fault}\n"))?;
    }
    if let Some(kept) = restored.kept {
        write_out(&format!("the database before it: {}\n", kept.display()))?;
    }
    for (key, name) in &restored.keys {
        let key = key.public();
        write_out(&format!("{key} {name:?} is not revoked in it: do so again if you had done so since\n"))?;
    }
    Ok(())
}

/// Says how far a copy without faults was looked into.
fn verified(copied: &Copied) -> &'static str {
    if copied.maps_checked {
        "verified"
    } else {
        "its structure is sound; its maps are of another schema and were not looked into"
    }
}

fn report(copied: &Copied) -> String {
    let holds = copied.holds;
    format!(
        "{}, {}, {}, schema {}",
        counted(holds.maps, "map"),
        counted(holds.keyframes, "keyframe"),
        counted(holds.anchors, "anchor"),
        holds.schema
    )
}
