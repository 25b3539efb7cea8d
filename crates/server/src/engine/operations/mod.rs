//! Operations: one file for each kind of resource that clients read and write.

mod alike_maps;
pub(super) mod anchors;
mod backups;
pub(super) mod changed_signs;
mod corrections;
pub(super) mod events;
pub(super) mod export;
pub(super) mod frames;
pub(super) mod judgements;
mod keyframe_reads;
pub(super) mod keyframes;
pub(super) mod locate;
pub(super) mod locate_maps;
pub(super) mod loops;
mod map_copies;
mod maps;
mod named;
pub(super) mod queries;
pub(super) mod releases;
pub(super) mod sessions;
pub(super) mod stats;
pub(super) mod text_functions;
pub(super) mod trajectories;
mod triggers;
pub(super) mod twins;
mod verdict_record;
pub(super) mod views;
