//! A map's key in the database: the number that stands in each of its rows, and that no other map ever gets.

/// A map's key in the database.
pub type MapKey = i64;
