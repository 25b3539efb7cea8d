//! Extractors: validated parts of a request.

mod arriving_body;
pub mod body;
pub mod body_errors;
pub mod decompression;
pub mod if_match;
pub mod frames_query;
pub mod path;
pub mod query;
pub mod trajectory_query;
