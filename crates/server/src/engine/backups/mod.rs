//! Backups: verified copies of the database in a folder that the operator has named.

pub(super) mod folder;
