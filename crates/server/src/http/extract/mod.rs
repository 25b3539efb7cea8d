//! Extractors: validated parts of a request.

pub mod answering;
mod arriving_body;
pub mod body;
pub mod body_errors;
pub mod decompression;
pub mod if_match;
pub mod min_version;
pub mod path;
pub mod query;
