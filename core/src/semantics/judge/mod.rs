//! The levels of two texts and of one, and what they rest on (§IV-A.2).

pub mod blocking_keys;
pub mod common_sign;
pub mod evidence;
pub mod information;
pub mod information_reason;
pub mod kind;
pub mod merge;
pub mod profile;
pub mod reason;
pub mod similarity;
