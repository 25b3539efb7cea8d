//! Restore: a backup becomes the database.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

use super::backup::{Copied, Copy, regular_or_free, sync_folder};
use super::check::check;
use crate::domain::counted::counted;
use crate::domain::key::KeySeq;
use crate::store::files::paths::DatabaseFiles;
use crate::store::{DatabaseLock, Purpose, StoreError, standing_keys};

/// Names tried for the database that was there, one for each second from now on.
const NAMES_TRIED: u64 = 1_000;

/// What a restore has done.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Restored {
    /// The database as it is now.
    pub copied: Copied,
    /// Where the one before is kept.
    pub kept: Option<PathBuf>,
    /// What is wrong with it, if that was allowed.
    pub faults: Vec<String>,
    /// The API keys that are not revoked in it, by number and name: what was revoked after the backup is good again.
    pub keys: Vec<(KeySeq, String)>,
}

/// What a restore may do that it refuses otherwise.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Allowed {
    /// Replace the database that is there; it is kept under another name.
    pub replace: bool,
    /// Restore a backup that has faults.
    pub faults: bool,
}

/// Verifies a backup and puts a copy of it where the database is, while nobody has that open. What was there is
/// refused to be touched, or kept under another name if that is allowed.
///
/// If the process dies on the way, no server starts on what it has left behind until a restore has come to its end.
pub async fn restore(
    backup: &DatabaseFiles,
    target: &DatabaseFiles,
    allowed: Allowed,
) -> Result<Restored, StoreError> {
    if backup.database() == target.database() {
        return Err(StoreError::InUse("the backup is the database itself".to_owned()));
    }
    let checked = check(backup).await?;
    if let Some(fault) = checked.all_faults().next().filter(|_| !allowed.faults) {
        let count = counted(checked.all_faults().count(), "fault");
        return Err(StoreError::File {
            path: backup.database().display().to_string(),
            error: format!("cannot be restored, it has {count}: {fault}"),
        });
    }
    // Before the lock, which stays behind: whoever is refused shall find nothing new.
    regular_or_free(target.database())?;
    if target.database().exists() && !allowed.replace {
        return Err(StoreError::Exists(target.database().display().to_string()));
    }
    let lock = DatabaseLock::take(target, Purpose::Restore)?;
    let copy = Copy::of(backup, target.folder()).await?;
    if let Some(fault) = copy.faults().first().filter(|_| !allowed.faults) {
        return Err(StoreError::corrupt(format!("the copy of the backup: {fault}")));
    }
    let faults = copy.faults().to_vec();
    let kept = if target.database().exists() { Some(put_aside(target)?) } else { None };
    // Of no use without its database, and deadly to another.
    for stale in [target.wal(), target.shm()] {
        if let Err(error) = fs::remove_file(&stale)
            && error.kind() != std::io::ErrorKind::NotFound
        {
            return Err(StoreError::file(&stale, &error));
        }
    }
    sync_folder(target.folder())?;
    let keys = standing_keys(backup).await?;
    let copied = copy.place(target.database(), false)?;
    lock.finished()?;
    Ok(Restored { copied, kept, faults, keys })
}

/// Gives the database another name, with its log: in the log may be all that was written last.
fn put_aside(target: &DatabaseFiles) -> Result<PathBuf, StoreError> {
    let second = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs());
    let name = |number: u64| target.beside(&format!(".before-{number}"));
    let free = |name: &PathBuf| !name.exists() && !DatabaseFiles::of_path(name).wal().exists();
    // What an interrupted restore has left is somebody's log, perhaps this very one under its second name.
    let kept = (second..second + NAMES_TRIED).map(name).find(free);
    let kept = kept.ok_or_else(|| StoreError::Exists(name(second).display().to_string()))?;
    let kept = DatabaseFiles::of_path(&kept);
    let failed = |path: &Path| {
        let path = path.to_owned();
        move |error: std::io::Error| StoreError::file(&path, &error)
    };
    // The log's second name first: the kept database is whole from the moment it has its name.
    if target.wal().exists() {
        let linked = fs::hard_link(target.wal(), kept.wal());
        linked.or_else(|_| copied(&target.wal(), &kept.wal())).map_err(failed(&kept.wal()))?;
    }
    fs::rename(target.database(), kept.database()).map_err(failed(target.database()))?;
    sync_folder(target.folder())?;
    Ok(kept.database().to_owned())
}

/// For file systems without second names. Never onto a file that is there: it may be the same one.
fn copied(from: &Path, to: &Path) -> std::io::Result<()> {
    let mut copy = fs::OpenOptions::new().write(true).create_new(true).open(to)?;
    std::io::copy(&mut fs::File::open(from)?, &mut copy)?;
    copy.sync_all()
}
