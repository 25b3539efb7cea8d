//! Files: the database, and what lies beside it.

use std::ffi::OsString;
use std::fs::OpenOptions;
use std::os::unix::fs::OpenOptionsExt as _;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::time::{Duration, SystemTime};

use sqlx::sqlite::SqliteConnectOptions;

use crate::StoreError;
use crate::address::{is_server_url, without_password};

/// Longest wait for a lock that another process holds.
pub(crate) const BUSY_TIMEOUT: Duration = Duration::from_secs(10);

/// Where a database lies.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DatabaseFiles {
    database: PathBuf,
}

/// Bytes of a write-ahead log before its first frame.
pub(crate) const LOG_HEADER_BYTES: u64 = 32;

/// How large a database is, in bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FileSizes {
    /// The database itself.
    pub database: u64,
    /// The write-ahead log, which checkpoints bring into the database.
    pub wal: u64,
}

impl DatabaseFiles {
    /// Returns the files of `sqlite://PATH`; the scheme may be left out.
    pub fn of_url(url: &str) -> Result<Self, StoreError> {
        if is_server_url(url) {
            let detail = format!(
                "{} is a server's database and no file: PostgreSQL's own tools check it and back it up, and a map comes out of it \
                 by GET /v1/maps/{{map}}/export",
                without_password(url)
            );
            return Err(StoreError::Database(detail));
        }
        let path = url.strip_prefix("sqlite:").map_or(url, |rest| rest.strip_prefix("//").unwrap_or(rest));
        if path.is_empty() || path.contains("://") {
            let detail = format!("{url:?} names no database; name a file, such as sqlite://revisit.db");
            return Err(StoreError::Database(detail));
        }
        let options = SqliteConnectOptions::from_str(url)?;
        if options.get_filename().to_string_lossy().starts_with("file:sqlx-in-memory") {
            let detail = format!("{url} is kept in memory only; name a file, such as sqlite://revisit.db");
            return Err(StoreError::Database(detail));
        }
        Ok(Self::of_path(options.get_filename()))
    }

    /// Returns the files of the database at this path.
    pub fn of_path(path: &Path) -> Self {
        // One database has one name, whatever links lead to it: its lock hangs on the name.
        let resolved = path.canonicalize().or_else(|_| {
            let absolute = std::path::absolute(path)?;
            let (Some(folder), Some(name)) = (absolute.parent(), absolute.file_name()) else {
                return Ok(absolute);
            };
            folder.canonicalize().map(|folder| folder.join(name))
        });
        Self { database: resolved.unwrap_or_else(|_: std::io::Error| path.to_owned()) }
    }

    /// Returns the database.
    pub fn database(&self) -> &Path {
        &self.database
    }

    /// Returns the file whose time of change is that of the newest copy by `revisit backup`.
    pub fn backup_mark(&self) -> PathBuf {
        let mut mark = self.database.as_os_str().to_owned();
        mark.push("-backup-taken");
        PathBuf::from(mark)
    }

    /// Notes that `revisit backup` has taken a copy now.
    pub fn mark_backup(&self) -> Result<(), StoreError> {
        let mark = self.backup_mark();
        let touch = || {
            let file = private().create(true).truncate(false).open(&mark)?;
            file.set_modified(SystemTime::now())
        };
        touch().map_err(|error| StoreError::file(&mark, &error))
    }

    /// Returns how many bytes its disk has left for this process; none if that is not known.
    pub fn free_bytes(&self) -> Option<u64> {
        let disk = rustix::fs::statvfs(self.folder()).ok()?;
        Some(disk.f_bavail.saturating_mul(disk.f_frsize))
    }

    /// Returns the folder it lies in.
    pub fn folder(&self) -> &Path {
        self.database.parent().unwrap_or(Path::new("."))
    }

    /// Its write-ahead log.
    pub fn wal(&self) -> PathBuf {
        self.beside("-wal")
    }

    /// Returns the log's index, shared by the processes that have the database open.
    pub fn shm(&self) -> PathBuf {
        self.beside("-shm")
    }

    /// Returns the file whose lock says who may write.
    pub fn lock(&self) -> PathBuf {
        self.beside(".lock")
    }

    /// Whether there is a file.
    pub fn exist(&self) -> bool {
        self.database.is_file()
    }

    /// Whether this path is the database, or one of the files without which it is not whole.
    pub fn hold(&self, path: &Path) -> bool {
        let asked = Self::of_path(path).database;
        asked == self.database
            || ["-wal", "-shm", "-journal", "-reserve", ".lock"]
                .iter()
                .any(|suffix| asked == self.beside(suffix))
    }

    /// Makes the database's file if it is not there, for its owner only: it holds hashes of keys, and every crop. SQLite
    /// gives its log the same mode.
    pub(crate) fn make(&self) -> Result<(), StoreError> {
        match private().create_new(true).open(&self.database) {
            Err(error) if error.kind() != std::io::ErrorKind::AlreadyExists => {
                Err(StoreError::file(&self.database, &error))
            }
            _ => Ok(()),
        }
    }

    /// Returns a file named like the database, and more.
    pub fn beside(&self, suffix: &str) -> PathBuf {
        let mut name = OsString::from(&self.database);
        name.push(suffix);
        name.into()
    }

    /// Returns how large they are now; what is not there is nothing.
    pub fn sizes(&self) -> FileSizes {
        let size = |path: &Path| std::fs::metadata(path).map_or(0, |metadata| metadata.len());
        FileSizes { database: size(&self.database), wal: size(&self.wal()) }
    }

    /// Returns how to open it beside a running server, without writing to it.
    pub(crate) fn read_only(&self) -> SqliteConnectOptions {
        SqliteConnectOptions::new()
            .filename(&self.database)
            .read_only(true)
            .create_if_missing(false)
            .busy_timeout(BUSY_TIMEOUT)
    }

    /// Returns how to open it so that the log's index stays as it is, too: it may be the only witness of what was committed.
    pub(crate) fn untouched(&self, log_is_damaged: bool) -> SqliteConnectOptions {
        let options = self.read_only();
        let has_frames = self.sizes().wal > LOG_HEADER_BYTES;
        match self.database.to_str() {
            // No process has it open so, and all there is to read is the database itself.
            _ if log_is_damaged && !has_frames => options.immutable(true),
            // Without an index there is none to keep, and SQLite needs to make one.
            Some(path) if has_frames && self.shm().exists() => {
                options.filename(format!("file:{}?readonly_shm=1", encoded(path)))
            }
            _ => options,
        }
    }
}

/// Returns a path as a part of an address.
fn encoded(path: &str) -> String {
    let plain = |byte: u8| byte.is_ascii_alphanumeric() || b"/._-".contains(&byte);
    let part = |byte: u8| if plain(byte) { char::from(byte).to_string() } else { format!("%{byte:02x}") };
    path.bytes().map(part).collect()
}

/// To write a file that is its owner's only, if it is made now.
pub(crate) fn private() -> OpenOptions {
    let mut options = OpenOptions::new();
    options.write(true).mode(0o600);
    options
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_database_has_one_lock_whatever_it_is_called() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("a.db");
        let direct = DatabaseFiles::of_path(&file);
        let around = DatabaseFiles::of_path(&folder.path().join(".").join("a.db"));
        assert_eq!(direct, around);
        std::fs::write(&file, "").unwrap();
        std::os::unix::fs::symlink(&file, folder.path().join("b.db")).unwrap();
        assert_eq!(DatabaseFiles::of_path(&folder.path().join("b.db")).lock(), direct.lock());
        for none in ["sqlite::memory:", "", "sqlite:", "sqlite://", "postgres://host/base"] {
            assert!(DatabaseFiles::of_url(none).is_err(), "{none}");
        }
    }
}
