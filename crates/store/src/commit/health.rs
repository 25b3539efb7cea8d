//! Health: whether the disk takes writes, as far as the writer knows.
//!
//! A write that fails costs its map a new load from the disk. So while the disk is known to be full or broken, writes
//! are refused before they are decided, and the writer itself tries now and then whether it is well again.

use std::sync::Arc;
use std::sync::atomic::{AtomicU8, Ordering};

use crate::StoreError;

/// What the writer knows of the disk; clones share it.
#[derive(Clone, Debug, Default)]
pub(crate) struct Health(Arc<AtomicU8>);

/// The state of the disk.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Disk {
    /// It takes writes.
    Well,
    /// It is full: only deletes are tried.
    Full,
    /// It fails: nothing is tried.
    Failing,
}

impl Health {
    pub(crate) fn disk(&self) -> Disk {
        match self.0.load(Ordering::Acquire) {
            0 => Disk::Well,
            1 => Disk::Full,
            _ => Disk::Failing,
        }
    }

    pub(crate) fn set(&self, disk: Disk) {
        let before = self.disk();
        self.0.store(disk as u8, Ordering::Release);
        if before != disk {
            tracing::warn!(?before, now = ?disk, "the disk changed");
        }
    }

    /// Learns from an error.
    pub(crate) fn learn(&self, error: &StoreError) {
        match error {
            StoreError::DiskFull => self.set(Disk::Full),
            StoreError::Disk(_) | StoreError::Away(_) => self.set(Disk::Failing),
            _ => {}
        }
    }

    /// Why a write need not be tried now. One that frees space is tried on a full disk.
    pub(crate) fn refuses(&self, frees_space: bool) -> Option<StoreError> {
        match self.disk() {
            Disk::Full if !frees_space => Some(StoreError::DiskFull),
            Disk::Well | Disk::Full => None,
            Disk::Failing => Some(StoreError::Disk("an earlier write failed".to_owned())),
        }
    }
}
