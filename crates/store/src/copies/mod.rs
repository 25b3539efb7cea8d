//! Copies: rows of whole maps, and of whole databases, as they are.

pub(super) mod copied_rows;
pub(super) mod transferred_rows;
