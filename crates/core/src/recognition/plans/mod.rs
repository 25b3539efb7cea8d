//! Plans: from signs that robots read and signs that a plan shows to the transformation between a session and the plan (M55).
//!
//! Nothing here is stored. An alignment follows from the facts of the map alone, so every reader of one version gets the same.
//!
//! | step | file |
//! |---|---|
//! | the signs that a session saw, and what the plan shows with their texts | [`session_signs`] |
//! | which drawn signs bear a text | [`plan_texts`] |
//! | the vertical of a session's frame | [`upright`] |
//! | a rotation about the vertical and a translation, fitted, with its uncertainty | [`planar_fit`] |
//! | how well a transformation explains all signs | [`support`] |
//! | transformations that two signs propose | [`proposals`] |
//! | the best one, and whether it stands alone | [`alignment`] |
//! | the alignment of a session, from the facts of its map | [`plan_alignment`] |
//! | all sessions of a map, and the place of an anchor in a plan | [`alignments`] |

pub mod alignment;
pub mod alignments;
pub mod plan_alignment;
pub mod plan_texts;
pub mod planar_fit;
pub mod proposals;
pub mod session_signs;
pub mod signs;
pub mod support;
pub mod upright;
