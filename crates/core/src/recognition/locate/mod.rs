//! "Where am I?": one or several keyframes of an unknown place against one or several maps.
//!
//! Not in the paper, whose loops are looked for in one map, by a robot that knows what it has just seen. The steps are those
//! of §V, and then what many maps and no pose of one's own ask for:
//!
//! | step | file |
//! |---|---|
//! | candidates of one map, with checks 2 and 3 | [`map_search`] |
//! | the keyframes that stand for places | [`sites`] |
//! | poses from anchors alone, whatever the words say | [`anchor_pose`], [`sighted_anchor`] |
//! | the few candidates of all maps that geometry looks at | [`selection`] |
//! | geometry, and how much of the view it explains | [`views`], [`explained_cells`] |
//! | views and anchor poses of one place | [`places`] |
//! | whether the building repeats itself | [`likeness`] |
//! | how sure it is | [`crate::recognition::odds::place`] |
//! | the pose, and how well it is known | [`pose`] |
//! | the signs that would tell places apart | [`look_for`] |
//! | the answer | [`locate()`] |

pub mod anchor_pose;
pub mod answer;
pub mod explained_cells;
pub mod likeness;
pub mod look_for;
pub mod map_search;
pub mod places;
pub mod pose;
pub mod selection;
pub mod sighted_anchor;
pub mod sites;
pub mod views;

pub use answer::locate;
