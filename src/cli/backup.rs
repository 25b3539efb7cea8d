//! `revisit backup` and `revisit restore`: verified copies of the database.

use std::path::PathBuf;

use clap::Args;

use super::check::contents;
use super::failure::Failure;
use super::output::write_out;
use crate::integrity::backup::{Copied, Copy, folder_of, regular_or_free};
use crate::integrity::restore::{Allowed, restore};
use crate::store::files::paths::DatabaseFiles;

/// Added to the name of a copy that has faults.
const DAMAGED: &str = "damaged";

/// Maximum faults listed; `revisit check --json` lists all.
const LISTED: usize = 20;

/// Copy the database into a file, even while a server is running.
///
/// The copy is a snapshot with every write acknowledged before the backup began. When the command ends, it is on disk
/// and verified by the same check as `check`. A copy with faults is kept as FILE.damaged, an earlier backup in FILE is
/// kept, and the exit code is 1. The backup needs as much disk space as the data, and the write-ahead log grows with
/// every write until it is done.
#[derive(Args, Debug)]
pub struct BackupArgs {
    /// The file to write
    file: PathBuf,
    /// The database
    #[arg(long, env = "REVISIT_DATABASE", value_name = "URL", default_value = "sqlite://revisit.db")]
    database: String,
    /// Replace an existing file
    #[arg(long, env = "REVISIT_FORCE")]
    force: bool,
}

/// Restore the database from a backup; no server may have it open.
///
/// The backup is checked first, as by `check`. Nothing is overwritten: an existing database is kept under another
/// name. Run the command as the user of the server.
#[derive(Args, Debug)]
pub struct RestoreArgs {
    /// The backup
    file: PathBuf,
    /// The database to replace
    #[arg(long, env = "REVISIT_DATABASE", value_name = "URL", default_value = "sqlite://revisit.db")]
    database: String,
    /// Replace an existing database, which is kept under another name
    #[arg(long, env = "REVISIT_FORCE")]
    force: bool,
    /// Restore a backup that has faults: intact maps are served, damaged ones return 500
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
    // A running server tells its age. Where the folder is read-only, the backup is none the worse.
    if let Err(error) = database.mark_backup() {
        eprintln!("the server's metrics will not know of this backup: {error}");
    }
    let (file, holds, verified) = (args.file.display(), contents(&copied.holds), verified(&copied));
    Ok(write_out(&format!(
        "{file}: {holds}; {} bytes, {verified}, sha256 {}\n",
        copied.bytes, copied.sha256
    ))?)
}

/// Keeps a copy that has faults, under a name that cannot be mistaken for a backup, and returns the message about it.
fn keep_damaged(copy: Copy, args: &BackupArgs) -> Result<String, Failure> {
    let count = copy.faults().len();
    let listed = copy.faults()[..count.min(LISTED)].join("\n  ");
    let damaged = args.file.with_added_extension(DAMAGED);
    let copied = copy.place(&damaged, args.force)?;
    Ok(format!(
        "not verified: the database has faults ({count}), and so has the copy, which is kept as {} ({} bytes, sha256 {}); \
         {} is unchanged. `revisit restore` accepts such a copy only with --damaged.\n  {listed}",
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
    let holds = contents(&restored.copied.holds);
    // Its sum is not printed: SQLite has rewritten the file, so the sum differs from the backup's.
    let verified = match restored.faults.len() {
        0 => verified(&restored.copied).to_owned(),
        count => format!("not verified, faults: {count}"),
    };
    write_out(&format!("{}: {holds}, {verified}\n", target.database().display()))?;
    for fault in restored.faults.iter().take(LISTED) {
        write_out(&format!("fault: {fault}\n"))?;
    }
    if let Some(kept) = restored.kept {
        write_out(&format!("previous database: {}\n", kept.display()))?;
    }
    for (key, name) in &restored.keys {
        let key = key.public();
        write_out(&format!(
            "{key} {name:?} is not revoked in the backup: if you revoked it since, revoke it again\n"
        ))?;
    }
    Ok(())
}

/// Returns the extent to which a copy without faults was verified.
fn verified(copied: &Copied) -> &'static str {
    if copied.maps_checked {
        "verified"
    } else {
        "its structure is sound; its maps have another schema and were not checked"
    }
}
