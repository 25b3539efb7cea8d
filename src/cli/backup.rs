//! `revisit backup`, `revisit restore`: a verified copy of the database, and back.

use std::path::PathBuf;

use clap::Args;

use super::{Failure, write_out};
use crate::model::counted::counted;
use crate::store::backup::{Copied, Copy, folder_of};
use crate::store::files::DatabaseFiles;
use crate::store::restore::restore;

/// Copy the database into a file, also while a server runs.
///
/// The copy is what the database held at one moment: everything acknowledged before the backup began is in it. It is
/// verified and on disk when the command ends. It needs as much room as the data, and the server's log grows meanwhile by
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
/// The backup is checked first. Nothing is overwritten: the database that is there keeps lying beside, under another
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
    let copied = Copy::of(&database, folder_of(&args.file)).await?.place(&args.file, args.force)?;
    let (file, holds) = (args.file.display(), told(&copied));
    Ok(write_out(&format!("{file}: {holds}; {} bytes, verified, sha256 {}\n", copied.bytes, copied.sha256))?)
}

/// Runs `restore`.
pub async fn run_restore(args: RestoreArgs) -> Result<(), Failure> {
    let target = DatabaseFiles::of_url(&args.database)?;
    let restored = restore(&DatabaseFiles::of_path(&args.file), &target, args.force).await?;
    let holds = told(&restored.copied);
    // Its sum is not told: SQLite has written it anew, and it differs from the backup's.
    write_out(&format!("{}: {holds}, verified\n", target.database().display()))?;
    if let Some(kept) = restored.kept {
        write_out(&format!("the database before it: {}\n", kept.display()))?;
    }
    for (key, name) in &restored.keys {
        let key = key.public();
        write_out(&format!("{key} {name:?} is not revoked in it: do so again if you had done so since\n"))?;
    }
    Ok(())
}

fn told(copied: &Copied) -> String {
    let holds = copied.holds;
    format!(
        "{}, {}, {}, schema {}",
        counted(holds.maps, "map"),
        counted(holds.keyframes, "keyframe"),
        counted(holds.anchors, "anchor"),
        holds.schema
    )
}
