//! Lock: one process at a time may write to a database.
//!
//! Not the lock of SQLite, which readers beside the server share: a file of its own (`PATH.lock`), locked as a whole,
//! so that the system releases it whatever becomes of the process. The file stays, for deleting it would let two processes
//! lock two files of one name. Its content tells the next who had it last.

use std::fs::{File, TryLockError};
use std::io::{Read as _, Seek as _, SeekFrom, Write as _};

use super::StoreError;
use super::files::{DatabaseFiles, private};

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
}

impl DatabaseLock {
    /// Takes the lock, or says who has it. A server is refused what an unfinished restore has left behind.
    pub fn take(files: &DatabaseFiles, purpose: Purpose) -> Result<Self, StoreError> {
        let path = files.lock();
        let failed = |error: std::io::Error| StoreError::file(&path, &error);
        let open = private().read(true).create(true).truncate(false).open(&path);
        let file = open.map_err(failed)?;
        let taken = file.try_lock();
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
        let mut lock = Self { file };
        lock.say(&format!("{}, process {}\n", purpose.as_str(), std::process::id())).map_err(failed)?;
        Ok(lock)
    }

    /// Keeps writers out while a database is read that no server has open; `None` if one has, or nobody ever had.
    pub(super) fn share(files: &DatabaseFiles) -> Option<File> {
        let file = File::open(files.lock()).ok()?;
        file.try_lock_shared().ok()?;
        Some(file)
    }

    /// What it was held for is done: nobody has to know any more.
    pub fn finished(mut self) -> Result<(), StoreError> {
        self.say("")
            .map_err(|error| StoreError::File { path: "the lock".to_owned(), error: error.to_string() })
    }

    /// Lets the next have it, though this value is still there.
    pub(super) fn release(&self) {
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

#[cfg(test)]
mod tests {
    use super::*;

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
