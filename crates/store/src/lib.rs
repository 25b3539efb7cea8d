//! The store: every fact in plain SQL tables, on disk before it is acknowledged.
//!
//! | concept | file |
//! |---|---|
//! | the handle; opening, pragmas, migrations | [`mod@store`], [`opening`], [`migrations`], [`files::schema`], [`postgres`] |
//! | one SQL for SQLite and PostgreSQL | [`sql`] |
//! | one writer in a thread of its own, group commit | [`commit::commit_queue`], [`commit::queue`], [`commit::lanes`], [`commit::group_commit`] |
//! | how much at a time | [`sizes`] |
//! | large deletions and corrections, in slices | [`slices::background`], [`slices::deletion`], [`commit::staging`], [`loading::deferred`], [`slices::fold`] |
//! | what a map was sent beside its rows, and all of it read back in order | [`log`], [`export`] |
//! | what it is asked to do, and what that costs | [`jobs::job`], [`jobs::cost`] |
//! | from changes to rows, a group at a time | [`commit::write`], [`commit::additions`], [`columns::bulk_insert`], [`rows::map_rows`], [`rows::keyframe_rows`] |
//! | from rows to changes, when a map is first asked for | [`facts`], [`fact_sources`], [`loading::load`], [`rows::decode`], [`rows::validate`] |
//! | what models said, and what it cost | [`rows::model_rows`] |
//! | jobs that ask models again, and the verdicts they replaced | [`rows::judgement_rows`], [`erasing::unsaid`] |
//! | releases, and copies of maps | [`map_copy`], [`copies::copied_rows`], [`rows::release_rows`], [`rows::map_tables`] |
//! | a whole database on its way into another one | [`mod@transfer`], [`copies::transferred_rows`] |
//! | what leaves for good | [`erasing::erasure_rows`], [`erasing::traces`], [`commit::renewal`] |
//! | API keys | [`rows::key_rows`] |
//! | reads of one row | [`loading::read`] |
//! | the words of a map that is not in memory | [`loading::words_of_map`] |
//! | a disk that is full or fails | [`commit::health`], [`commit::own_disk`], [`files::disk_reserve`], [`sql::transaction`], [`files::wal_recovery`] |
//! | packed lists in blobs | [`columns::blob`] |
//! | where it lies, and who may write to it | [`address`], [`files::paths`], [`files::lock`] |
//! | copies of it, and what it holds | [`files::copying`], [`holdings`] |
//! | looking at it as it is | [`inspection`], [`files::log`] |

mod address;
mod columns;
mod commit;
mod copies;
mod erasing;
mod error;
mod export;
mod fact_sources;
mod facts;
pub mod files;
mod holdings;
mod inspection;
mod jobs;
mod loading;
mod log;
mod map_copy;
mod map_key;
mod migrations;
mod opening;
mod postgres;
mod rows;
mod sizes;
mod slices;
#[cfg(test)]
mod slices_equal_direct_writes;
mod sql;
mod store;
#[cfg(test)]
mod test_database;
mod transfer;

pub use address::{is_server_url, without_password};
pub use commit::commit_queue::{CommitStats, Committer};
pub use commit::health::Disk;
pub use commit::queue::PoisonFlag;
pub use copies::transferred_rows::HeldMap;
pub use erasing::erasure_rows::OpenErasure;
pub use error::StoreError;
pub use export::Export;
pub use fact_sources::FactsForCopies;
pub use facts::{FactSource, MapFacts, Order};
pub use files::lock::{DatabaseLock, Purpose};
pub use files::log::LogFindings;
pub use files::schema::newest as newest_schema;
pub use holdings::Holdings;
pub use inspection::{Inspected, Inspection, RowFindings};
pub use jobs::job::{Batch, CopiedAs, ErasureStep, Job, NewKeyRow, NewKeyframeRows, Spent};
pub use jobs::row_block::RowBlock;
pub use loading::read::{DetectionRow, KeyframeRow};
pub use loading::words_of_map::MapOutline;
pub use map_copy::MapCopy;
pub use map_key::MapKey;
pub use postgres::change_log::News;
pub use postgres::leases::{Lease, Leases, Taken};
pub use postgres::nodes::{LiveNode, Node, Owner};
pub use postgres::shares::{DayLimit, Elsewhere};
pub use rows::judgement_rows::Fingerprints;
pub use rows::key_rows::{KeyTable, standing_keys};
pub use rows::map_rows::MapRow;
pub use rows::model_rows::Totals;
pub use rows::release_rows::RELEASE_USES_MAX;
pub use rows::unpacks::unpacks;
pub use rows::verdict_rows::GivenAnswer;
pub use sizes::use_small_sizes;
pub use sql::cell::Cell;
pub use sql::connection::Engine;
pub use store::Store;
