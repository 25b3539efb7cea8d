//! Numbers and codes that name one object.

pub mod agreement;
pub mod identifier;
pub mod numbering;
