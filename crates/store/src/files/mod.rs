//! Files: the database, its log, its lock, and the space reserved beside it.

pub mod copying;
pub(super) mod disk_reserve;
pub(super) mod lock;
pub(super) mod log;
pub mod paths;
pub(super) mod schema;
pub(super) mod wal_recovery;
