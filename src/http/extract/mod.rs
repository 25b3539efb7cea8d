//! Extractors: what a request contains, checked.

pub mod body;
pub mod decompression;
pub mod if_match;
pub mod path;
pub mod query;
pub mod trajectory_query;
