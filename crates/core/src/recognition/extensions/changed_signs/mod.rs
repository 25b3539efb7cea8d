//! Signs that change: a plate that was replaced is retired (M18).
//!
//! A place whose only plate has a new number would stay rejected for ever, for the old plate contradicts the new one. So a
//! keyframe that arrives ends the passages of those signs that its session has left behind, and each of them is judged:
//!
//! | step | file |
//! |---|---|
//! | which signs a camera should see | [`expected`] |
//! | the passages that have ended | [`passages`] |
//! | whether the robot was where its poses have it | [`place`] |
//! | what a keyframe read of a sign | `readings` |
//! | what the passage saw there | [`seen`] |
//! | three passages retire a sign, one returns it | [`judged`] |
//! | a new sign that has fed the old one's anchor | `split` |
//!
//! A keyframe's write tells which passages it ends. They are judged after it, in a version of the map of its own, because
//! geometry may have to look; what is found is kept, and nothing runs at load.

pub mod expected;
pub mod judged;
pub mod passages;
pub mod place;
mod readings;
pub mod seen;
mod split;

pub use expected::Sign;
pub use judged::{judge, looks};
pub use passages::{Passage, passages_ended_by};
pub use place::Look;
