//! Disk reserve: disk space kept beside the database, so that deletes still work when there is no other.
//!
//! A delete makes room only after it has written what it did to the write-ahead log. On a full disk the log is brought
//! into the database's file with this reserve's space, and is then there to be written from its beginning. The reserve is
//! made again before other writes go on.

use std::fs::File;
use std::path::{Path, PathBuf};

use rustix::fs::{FallocateFlags, fallocate, statvfs};
use rustix::io::Errno;

use super::paths::private;

/// The reserve, ...
const RESERVE_BYTES: u64 = 32 << 20;

/// ... which on a small disk is this part of it.
const PART_OF_DISK: u64 = 8;

/// The log is brought home when it is this part of the reserve: the database's file grows by no more than the log, and a
/// large group may be on top. So much must be free beside the reserve before writes go on.
const LOG_PART: u64 = 4;

/// The space kept.
#[derive(Clone, Debug)]
pub(crate) struct Reserve {
    path: PathBuf,
    bytes: u64,
}

impl Reserve {
    /// Returns the reserve of this database.
    pub(crate) fn beside(database: &Path) -> Self {
        let mut path = database.as_os_str().to_owned();
        path.push("-reserve");
        let path = PathBuf::from(path);
        let disk = statvfs(folder(&path));
        let part = |disk: rustix::fs::StatVfs| disk.f_blocks.saturating_mul(disk.f_frsize) / PART_OF_DISK;
        Self { bytes: disk.map_or(RESERVE_BYTES, |disk| RESERVE_BYTES.min(part(disk))), path }
    }

    /// Returns how long the write-ahead log may get, in pages of so many bytes, for the reserve to take it.
    pub(crate) fn log_pages(&self, page_bytes: u32) -> u64 {
        (self.bytes / LOG_PART / u64::from(page_bytes)).max(1)
    }

    /// Returns how much is kept where there is enough.
    pub(crate) fn bytes(&self) -> u64 {
        self.bytes
    }

    /// Makes sure that the space is kept, or a part of it that is `enough`, with room beside it. False if the disk has
    /// not got it; what there is is kept all the same.
    pub(crate) fn keep(&self, enough: u64) -> bool {
        let parts = [self.bytes, self.bytes / 2, self.bytes / 4, 0];
        let kept =
            parts.iter().filter(|part| **part >= enough).any(|part| self.allocate(*part) && self.is_room());
        if !kept {
            // Not left to others, who would make it impossible to delete.
            let _ = parts.iter().any(|part| self.allocate(*part));
        }
        kept
    }

    /// False if the disk has not got so much.
    fn allocate(&self, bytes: u64) -> bool {
        let allocate = || {
            let file = private().create(true).truncate(false).open(&self.path)?;
            if bytes < file.metadata()?.len() {
                file.set_len(bytes)?;
            }
            if bytes > 0 {
                fallocate(&file, FallocateFlags::empty(), 0, bytes)?;
            }
            Ok(())
        };
        match allocate() {
            Ok(()) => true,
            Err(error) if matches!(Errno::from_io_error(&error), Some(Errno::NOSPC | Errno::DQUOT)) => false,
            Err(error) => {
                // A file system that cannot promise space, or a directory of somebody else's: then without.
                let error: std::io::Error = error;
                tracing::debug!(%error, path = %self.path.display(), "no space is kept for deletes");
                true
            }
        }
    }

    /// Gives the space to whoever needs it now.
    pub(crate) fn release(&self) {
        let released = File::options().write(true).open(&self.path).and_then(|file| file.set_len(0));
        if let Err(error) = released {
            tracing::debug!(%error, path = %self.path.display(), "no space was kept for deletes");
        }
    }

    /// Whether there is room beside the reserve.
    fn is_room(&self) -> bool {
        let disk = statvfs(folder(&self.path));
        disk.map_or(true, |disk| disk.f_bavail.saturating_mul(disk.f_frsize) >= self.bytes / LOG_PART)
    }
}

fn folder(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}
