//! The index of one map in memory: its facts, and everything derived from them.
//!
//! The law that tests hold: an index built from the store equals the live one, after any
//! sequence of requests. So nothing here may depend on the order in which facts arrived
//! other than through the numbers that are facts themselves.

mod along_drive;
mod anchor;
mod apply;
mod changed_observations;
mod changed_signs;
mod codes;
mod covisibility;
mod globals;
mod holders;
mod learned;
mod map_index;
mod memory;
mod objects;
mod odometer;
mod open_merges;
mod parsed_readings;
mod points;
mod priors;
mod readings;
mod reverse;
mod sign_grid;
mod tally;
mod texts;
mod touched;
mod verdicts;
mod votes;
mod way;

pub(in crate::recognition) use along_drive::MAX_GAP_S;
pub use anchor::{Anchor, Shape};
pub use changed_signs::ChangedSigns;
pub use covisibility::Covisibility;
pub use globals::Globals;
pub use holders::Holders;
pub use map_index::MapIndex;
pub use objects::{Certainty, Description, MergedAnchor, Objects};
pub use odometer::{Milestone, Odometer, UM_PER_M};
pub use open_merges::{OpenMerge, OpenMerges};
pub use points::{POINT_BYTES, Points};
pub use priors::Priors;
pub use readings::Readings;
pub use sign_grid::{CELL_M, SignGrid};
pub use texts::{GroupId, IdentityId, TextId, TextIndex, WordGroups};
pub use verdicts::Verdicts;
pub use votes::Votes;
