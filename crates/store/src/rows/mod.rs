//! Rows: the mapping between SQL rows and values of the domain.

pub(super) mod changed_sign_rows;
pub(super) mod decode;
pub(super) mod frame_rows;
pub(super) mod judgement_rows;
pub(super) mod key_rows;
pub(super) mod keyframe_rows;
pub(super) mod map_rows;
pub(super) mod map_tables;
pub(super) mod model_rows;
pub(super) mod observation_rows;
pub(super) mod point_blocks;
pub(super) mod prior_rows;
pub(super) mod release_rows;
pub(super) mod session_merge_rows;
pub(super) mod twin_rows;
pub(super) mod unpacks;
pub(super) mod validate;
pub(super) mod verdict_rows;
