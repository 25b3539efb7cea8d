//! Reserve: disk space kept beside the database, so that deletes still work when there is no other.
//!
//! A delete makes room only after it has written what it did to the write-ahead log. On a full disk it gets this
//! file's space for that; the file is made again before other writes go on.

use std::fs::{File, OpenOptions};
use std::path::{Path, PathBuf};

use rustix::fs::{FallocateFlags, fallocate, statvfs};
use rustix::io::Errno;

/// Above what a checkpoint adds to the database's file, which grows by the log's pages before the log can be used again.
const RESERVE_BYTES: u64 = 32 << 20;

/// On a small disk the reserve is this part of it, ...
const PART_OF_DISK: u64 = 16;

/// ... and so is what must be free beside the reserve before writes go on.
const ROOM_BYTES: u64 = 8 << 20;

/// The space kept.
#[derive(Clone, Debug)]
pub(super) struct Reserve {
    path: PathBuf,
}

impl Reserve {
    /// The reserve of this database.
    pub(super) fn beside(database: &Path) -> Self {
        let mut path = database.as_os_str().to_owned();
        path.push("-reserve");
        Self { path: path.into() }
    }

    /// Makes sure that the space is kept. False if the disk has not got it.
    pub(super) fn keep(&self) -> bool {
        let kept = self.allocate();
        if kept == Some(Errno::NOSPC) || kept == Some(Errno::DQUOT) {
            return false;
        }
        if let Some(error) = kept {
            // A file system that cannot promise space, or a directory of somebody else's: then without.
            tracing::debug!(%error, path = %self.path.display(), "no space is kept for deletes");
        }
        true
    }

    fn allocate(&self) -> Option<Errno> {
        let errno = |error: &std::io::Error| Errno::from_io_error(error).unwrap_or(Errno::IO);
        let file = match OpenOptions::new().create(true).truncate(false).write(true).open(&self.path) {
            Ok(file) => file,
            Err(error) => return Some(errno(&error)),
        };
        let wanted = self.part_of_disk(RESERVE_BYTES);
        let failed = fallocate(&file, FallocateFlags::empty(), 0, wanted).err();
        if failed.is_some() {
            // Half a reserve would be what keeps the disk full.
            let _ = file.set_len(0);
        }
        failed
    }

    /// Gives the space to whoever needs it now.
    pub(super) fn release(&self) {
        let released = File::options().write(true).open(&self.path).and_then(|file| file.set_len(0));
        if let Err(error) = released {
            tracing::debug!(%error, path = %self.path.display(), "no space was kept for deletes");
        }
    }

    /// Is there room beside the reserve?
    pub(super) fn is_room(&self) -> bool {
        let folder = self.path.parent().filter(|folder| !folder.as_os_str().is_empty());
        match statvfs(folder.unwrap_or(Path::new("."))) {
            Ok(disk) => disk.f_bavail.saturating_mul(disk.f_frsize) >= self.part_of_disk(ROOM_BYTES),
            Err(_) => true,
        }
    }

    fn part_of_disk(&self, bytes: u64) -> u64 {
        let folder = self.path.parent().filter(|folder| !folder.as_os_str().is_empty());
        let disk = statvfs(folder.unwrap_or(Path::new(".")));
        disk.map_or(bytes, |disk| bytes.min(disk.f_blocks.saturating_mul(disk.f_frsize) / PART_OF_DISK))
    }
}
