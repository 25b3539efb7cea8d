//! Extensions: what we add to the paper, each stated in `docs/method.md`.

pub mod alignment;
pub mod changed_signs;
pub mod closed_return;
pub mod company;
pub mod contradiction;
pub mod difference;
pub mod dispute;
pub mod distinctiveness;
pub mod loop_warning;
pub mod passage;
pub mod returning;
pub mod rivals;
pub mod sighting;
pub mod sure_text;
pub mod tracked_path;
pub mod twins;
pub mod vouching;
pub mod way_by_loops;
pub mod witness;
pub mod worst_case;
