//! Map: the index of what a map holds, and how it is changed and searched.

pub mod changes_between;
pub mod correction;
pub mod covisibility;
pub mod covisible_groups;
pub mod culling;
pub mod dense_map;
pub mod index;
pub mod inverted_file;
pub mod recorder;
pub mod redundancy;
