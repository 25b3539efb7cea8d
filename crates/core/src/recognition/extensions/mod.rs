//! Extensions: what we add to the paper, each stated in `docs/method.md`.

pub mod changed_signs;
pub mod closed_return;
pub mod company;
pub mod contradiction;
pub mod distinctiveness;
pub mod loop_warning;
pub mod passage;
pub mod returning;
pub mod sighting;
pub mod tracked_path;
pub mod twins;
pub mod way_by_loops;
pub mod worst_case;
