//! Engine: the use cases, without HTTP and without SQL.
//!
//! | folder or file | concept |
//! |---|---|
//! | [`mod@service`], [`opening`], [`options`] | the handle that every use case is a method of; how it is opened and closed |
//! | [`operations`] | the use cases, one file for each kind of resource |
//! | [`maps`] | maps in memory: loading, the write path, eviction |
//! | [`descriptions`] | background work of models |
//! | [`limits`] | concurrency limits, load shedding, quotas |
//! | [`keys`] | API keys and their permissions |
//! | [`cluster`] | several servers over one database: which has which map |
//! | [`backups`] | the folder of backups |
//! | [`erasures`], [`retention`] | keyframes that leave for good; what settings let go of |
//!
//! For every write: the map's lock, a pure decision of [`crate::recognition`], its changes applied to
//! the index and queued for the store, and the answer when they are on disk. Reads look at the
//! index, and at the store for what is only there.

mod backups;
mod cluster;
mod descriptions;
mod erasures;
mod error;
pub mod keys;
pub mod limits;
pub mod lock;
mod maps;
mod named_vocabulary;
mod opening;
mod operations;
mod options;
#[cfg(test)]
mod rebuild_equals_live;
mod retention;
mod service;
mod stored;
mod tasks;
mod vocabulary;

pub use backups::folder::BackupMade;
pub use cluster::routing::Route;
pub use error::{Result, ServiceError};
pub use maps::feeds::Listener;
pub use maps::loads::LoadFigures;
pub use maps::pinned::PinnedMap;
pub use operations::export::MapExport;
pub use operations::keyframes::PendingKeyframe;
pub use operations::locate::LocateAnswer;
pub use operations::locate_maps::AskedMap;
pub use operations::loops::ConfirmedLoop;
pub use operations::queries::{QueryAnswer, Timings};
pub use operations::stats::Stats;
pub use options::{ModelChoice, ServiceOptions, WriteAnswer};
pub use service::Service;
pub use stored::Stored;
