//! Integrity: proofs that a database is whole, and copies that are proven before they have a name.
//!
//! | concept | file |
//! |---|---|
//! | the proof | [`mod@check`], [`map_check`], [`rebuild`] |
//! | copies of the database, and back | [`backup`], [`mod@restore`] |
//! | everything into another database | [`mod@transfer`] |

pub mod backup;
pub mod check;
pub mod map_check;
pub mod rebuild;
pub mod restore;
pub mod transfer;
