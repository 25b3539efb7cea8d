//! Backup: a whole copy of the database as it is at one moment, beside a running server, verified before it has its name.

use std::fs::File;
use std::io::Read as _;
use std::path::{Path, PathBuf};

use sha2::{Digest as _, Sha256};
use tempfile::NamedTempFile;

use super::check::check_any_schema;
use crate::store::files::copying;
use crate::store::files::paths::DatabaseFiles;
use crate::store::{Holdings, StoreError};

/// How a copy is called until it is whole; one that a crash has left behind is known by it.
pub const PARTIAL: &str = ".revisit-partial";

/// Read at a time for the digest.
const CHUNK_BYTES: usize = 1 << 20;

/// A copy that is on disk.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Copied {
    /// Its size.
    pub bytes: u64,
    /// Its SHA-256, in hexadecimal.
    pub sha256: String,
    /// What it holds.
    pub holds: Holdings,
    /// Whether its maps were looked into: its schema is this program's.
    pub maps_checked: bool,
}

/// A copy under a name of its own, which goes with this value unless it is given its place.
#[derive(Debug)]
pub struct Copy {
    file: NamedTempFile,
    pub(crate) copied: Copied,
    faults: Vec<String>,
}

impl Copy {
    /// Copies a database into a folder, also while a server has it open: the copy is what one read transaction sees.
    pub async fn of(source: &DatabaseFiles, folder: &Path) -> Result<Self, StoreError> {
        let file = unnamed(folder)?;
        let schema = copying::copy(source, &absolute(file.path())?).await?;
        Self::checked(file, schema, Vec::new()).await
    }

    /// Copies a database that this process does not have open, and looks at its log first.
    pub async fn from_outside(source: &DatabaseFiles, folder: &Path) -> Result<Self, StoreError> {
        let file = unnamed(folder)?;
        let (schema, of_log) = copying::copy_from_outside(source, &absolute(file.path())?).await?;
        Self::checked(file, schema, of_log).await
    }

    async fn checked(file: NamedTempFile, schema: i64, of_log: Vec<String>) -> Result<Self, StoreError> {
        let copy = DatabaseFiles::of_path(file.path());
        let checked = check_any_schema(&copy).await?;
        let mut faults: Vec<String> = checked.all_faults().collect();
        let holds = match checked.newer {
            Some(_) => Holdings::of_file(&copy).await?,
            None => checked.holds.unwrap_or_default(),
        };
        let maps_checked = checked.newer.is_none();
        if faults.is_empty() && holds.schema != schema {
            faults.push(format!("the copy has schema {}, not {schema}", holds.schema));
        }
        faults.extend(of_log);
        let write = move || {
            let path = file.path().to_owned();
            let failed = |error: std::io::Error| StoreError::file(&path, &error);
            file.as_file().sync_all().map_err(failed)?;
            let (bytes, sha256) = digest(&path).map_err(failed)?;
            Ok(Self { file, copied: Copied { bytes, sha256, holds, maps_checked }, faults })
        };
        tokio::task::spawn_blocking(write).await.map_err(|error| StoreError::Database(error.to_string()))?
    }

    /// Returns everything that [`super::check::check`] found wrong with the copy; a verified one has no faults.
    pub fn faults(&self) -> &[String] {
        &self.faults
    }

    /// Gives the copy its name, which is on disk when this returns. A regular file that has the name is replaced, or
    /// kept; anything else that has it (a device, a folder, a link) is refused.
    pub fn place(self, path: &Path, replace: bool) -> Result<Copied, StoreError> {
        regular_or_free(path)?;
        let placed = if replace { self.file.persist(path) } else { self.file.persist_noclobber(path) };
        placed.map_err(|refused| match refused.error.kind() {
            std::io::ErrorKind::AlreadyExists => StoreError::Exists(path.display().to_string()),
            _ => StoreError::file(path, &refused.error),
        })?;
        sync_folder(folder_of(path))?;
        Ok(self.copied)
    }
}

/// Returns the folder that a file lies in.
pub fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Makes what was named, renamed or removed in a folder last.
pub fn sync_folder(folder: &Path) -> Result<(), StoreError> {
    File::open(folder).and_then(|opened| opened.sync_all()).map_err(|error| StoreError::file(folder, &error))
}

/// Rejects a path under which something lies that is not a regular file: a rename would replace a device node, too.
pub fn regular_or_free(path: &Path) -> Result<(), StoreError> {
    match std::fs::symlink_metadata(path) {
        Ok(found) if found.is_file() => Ok(()),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(()),
        Err(error) => Err(StoreError::file(path, &error)),
        Ok(_) => Err(StoreError::File {
            path: path.display().to_string(),
            error: "is not a regular file, and nothing else is replaced".to_owned(),
        }),
    }
}

/// Makes the file of a copy, without a name that a backup could have.
fn unnamed(folder: &Path) -> Result<NamedTempFile, StoreError> {
    let file = tempfile::Builder::new().prefix("").suffix(PARTIAL).tempfile_in(folder);
    file.map_err(|error| StoreError::file(folder, &error))
}

/// SQLite takes what begins with `file:` for an address.
fn absolute(path: &Path) -> Result<String, StoreError> {
    let absolute: PathBuf = std::path::absolute(path).map_err(|error| StoreError::file(path, &error))?;
    absolute.into_os_string().into_string().map_err(|path| StoreError::File {
        path: path.display().to_string(),
        error: "the name is not UTF-8".to_owned(),
    })
}

fn digest(path: &Path) -> std::io::Result<(u64, String)> {
    use std::fmt::Write as _;

    let mut file = File::open(path)?;
    let (mut hash, mut chunk, mut bytes) = (Sha256::new(), vec![0; CHUNK_BYTES], 0);
    while let read @ 1.. = file.read(&mut chunk)? {
        bytes += read as u64;
        hash.update(&chunk[..read]);
    }
    let hex = hash.finalize().iter().fold(String::new(), |mut hex, byte| {
        let _ = write!(hex, "{byte:02x}");
        hex
    });
    Ok((bytes, hex))
}
