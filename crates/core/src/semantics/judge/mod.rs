//! The levels of two texts and of one, and what they rest on (§IV-A.2).

pub mod common_sign;
pub mod evidence;
pub mod information;
pub mod kind;
pub mod merge;
pub mod profile;
pub mod similarity;
