//! WAL recovery: what an earlier process left in the write-ahead log is written and synced once more before anything is built on it.
//!
//! If a sync failed, the kernel may have dropped what it was to write and still show it to readers until the machine
//! stops. A process that starts then takes it for committed, and commits after it; its own syncs succeed, and after
//! a power failure the log has a hole in front of what they had acknowledged. Written again, it is on disk or the sync says that
//! it is not. The process that saw the failure needs no renewal: SQLite writes its failed transaction's place anew.

use std::fs::{File, OpenOptions};
use std::io;
use std::os::unix::fs::FileExt as _;
use std::path::Path;

use sqlx::sqlite::SqlitePool;

use crate::StoreError;
use crate::sql::transaction::Transaction;

/// Bytes written at a time.
const CHUNK: usize = 1 << 20;

/// Renews the log of this database. The write lock is held meanwhile, so that nobody else writes to it.
pub(crate) async fn renew(writer: &SqlitePool, database: &Path) -> Result<(), StoreError> {
    let mut log = database.as_os_str().to_owned();
    log.push("-wal");
    let lock = Transaction::write(&writer.clone().into()).await?;
    let renewed = tokio::task::spawn_blocking(move || write_again(Path::new(&log))).await;
    lock.roll_back().await;
    match renewed {
        Ok(Ok(())) => Ok(()),
        // On file systems that never write in place; they do not show what they dropped, either.
        Ok(Err(error)) if error.kind() == io::ErrorKind::StorageFull => {
            tracing::warn!("the disk is full; the write-ahead log is taken as it is");
            Ok(())
        }
        Ok(Err(error)) => Err(StoreError::Disk(format!("the write-ahead log: {error}"))),
        Err(error) => Err(StoreError::Database(error.to_string())),
    }
}

fn write_again(log: &Path) -> io::Result<()> {
    let file = match OpenOptions::new().read(true).write(true).open(log) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(()),
        opened => opened?,
    };
    copy_in_place(&file)?;
    file.sync_all()
}

fn copy_in_place(file: &File) -> io::Result<()> {
    let mut bytes = vec![0; CHUNK];
    let mut at = 0;
    loop {
        let read = file.read_at(&mut bytes, at)?;
        if read == 0 {
            return Ok(());
        }
        file.write_all_at(&bytes[..read], at)?;
        at += read as u64;
    }
}
