//! Lock: one process at a time may write to a database.
//!
//! Not the lock of SQLite, which readers beside the server share: a file of its own (`PATH.lock`), locked as a whole,
//! so that the system releases it whatever becomes of the process. The file stays once a database was opened. Its content
//! tells the next who had it last.

use std::fs::{File, TryLockError};
use std::io::{Read as _, Seek as _, SeekFrom, Write as _};
use std::os::unix::fs::MetadataExt as _;
use std::path::{Path, PathBuf};

use super::paths::{DatabaseFiles, private};
use crate::StoreError;

/// What the database is held for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// A server reads and writes it.
    Serve,
    /// It is being replaced by another.
    Restore,
}

impl Purpose {
    fn as_str(self) -> &'static str {
        match self {
            Self::Serve => "serve",
            Self::Restore => "restore",
        }
    }
}

/// The right to write to a database; it ends with this value, and with the process.
#[derive(Debug)]
pub struct DatabaseLock {
    file: File,
    /// Where the file was made by this very lock: it goes again if no database is opened.
    made: Option<PathBuf>,
}

impl DatabaseLock {
    /// Takes the lock, or says who has it. A server is refused what an unfinished restore has left behind.
    pub fn take(files: &DatabaseFiles, purpose: Purpose) -> Result<Self, StoreError> {
        let path = files.lock();
        // People know the database, not its lock.
        let failed = |error: std::io::Error| StoreError::file(files.database(), &error);
        if files.database().exists() && !files.exist() {
            return Err(StoreError::File {
                path: files.database().display().to_string(),
                error: "is not a regular file".to_owned(),
            });
        }
        let (file, taken, made) = loop {
            let (file, made) = open(&path).map_err(failed)?;
            let taken = file.try_lock();
            // Where the file was removed meanwhile, another process may make and lock one of the same name.
            if taken.is_err() || is_at(&file, &path) {
                break (file, taken, made);
            }
        };
        let mut last = String::new();
        // Whatever stands there is only told.
        let _ = (&file).take(64).read_to_string(&mut last);
        match taken {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => {
                let by = if last.is_empty() { "another process" } else { last.trim_end() };
                let database = files.database().display();
                return Err(StoreError::InUse(format!(
                    "the database {database} is in use (by `{by}`, or by a check of it); only one process may write to \
                     it: stop that one first"
                )));
            }
            Err(TryLockError::Error(error)) => return Err(failed(error)),
        }
        if purpose == Purpose::Serve && last.starts_with(Purpose::Restore.as_str()) {
            let database = files.database().display();
            return Err(StoreError::InUse(format!(
                "a restore of {database} did not finish; run `revisit restore` again"
            )));
        }
        let mut lock = Self { file, made: made.then_some(path) };
        lock.say(&format!("{}, process {}\n", purpose.as_str(), std::process::id())).map_err(failed)?;
        Ok(lock)
    }

    /// Keeps writers out while a database is read that no server has open; `None` if one has, or nobody ever had.
    pub(crate) fn share(files: &DatabaseFiles) -> Option<File> {
        let file = File::open(files.lock()).ok()?;
        file.try_lock_shared().ok()?;
        is_at(&file, &files.lock()).then_some(file)
    }

    /// Returns what it was held for is done: nobody has to know any more.
    pub fn finished(mut self) -> Result<(), StoreError> {
        self.say("")
            .map_err(|error| StoreError::File { path: "the lock".to_owned(), error: error.to_string() })
    }

    /// Removes the lock's file if this lock has made it: nothing was opened.
    pub(crate) fn undo(&self) {
        if let Some(path) = &self.made {
            // While it is locked: who opens it after this makes another, and who has opened it looks whether it is there.
            let _ = std::fs::remove_file(path);
        }
    }

    /// Lets the next have it, though this value is still there.
    pub(crate) fn release(&self) {
        // Fails if the file is gone, and with it the lock.
        let _ = self.file.unlock();
    }

    fn say(&mut self, who: &str) -> std::io::Result<()> {
        self.file.set_len(0)?;
        self.file.seek(SeekFrom::Start(0))?;
        self.file.write_all(who.as_bytes())?;
        // After a power cut, too, a restore that did not finish must be known.
        self.file.sync_all()
    }
}

/// Opens the lock's file, and says whether it was made now.
fn open(path: &Path) -> std::io::Result<(File, bool)> {
    match private().read(true).create_new(true).open(path) {
        Err(error) if error.kind() == std::io::ErrorKind::AlreadyExists => {
            Ok((private().read(true).create(true).truncate(false).open(path)?, false))
        }
        made => Ok((made?, true)),
    }
}

/// Whether this file is the one that has this name now.
fn is_at(file: &File, path: &Path) -> bool {
    let identity = |metadata: std::fs::Metadata| (metadata.dev(), metadata.ino());
    match (file.metadata(), std::fs::metadata(path)) {
        (Ok(open), Ok(named)) => identity(open) == identity(named),
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lock_that_is_undone_leaves_no_file_unless_it_was_there() {
        let folder = tempfile::tempdir().unwrap();
        let files = DatabaseFiles::of_path(&folder.path().join("a.db"));
        let first = DatabaseLock::take(&files, Purpose::Serve).unwrap();
        first.undo();
        assert!(!files.lock().exists());
        // The next one has a file of its own, and the first no claim on it.
        let second = DatabaseLock::take(&files, Purpose::Serve).unwrap();
        drop((first, second));
        let third = DatabaseLock::take(&files, Purpose::Serve).unwrap();
        third.undo();
        assert!(files.lock().exists(), "it was there before");
    }

    #[test]
    fn one_has_it_at_a_time_and_an_unfinished_restore_keeps_servers_out() {
        let folder = tempfile::tempdir().unwrap();
        let files = DatabaseFiles::of_path(&folder.path().join("a.db"));
        let lock = DatabaseLock::take(&files, Purpose::Serve).unwrap();
        let refused = DatabaseLock::take(&files, Purpose::Restore).unwrap_err().to_string();
        assert!(refused.contains(&format!("serve, process {}", std::process::id())), "{refused}");
        assert!(DatabaseLock::share(&files).is_none());
        drop(lock);

        // A server that was killed says nothing to the next.
        let interrupted = DatabaseLock::take(&files, Purpose::Restore).unwrap();
        drop(interrupted);
        let refused = DatabaseLock::take(&files, Purpose::Serve).unwrap_err().to_string();
        assert!(refused.contains("did not finish"), "{refused}");
        DatabaseLock::take(&files, Purpose::Restore).unwrap().finished().unwrap();
        let _serving = DatabaseLock::take(&files, Purpose::Serve).unwrap();
    }
}
