//! Training: recorded descriptors become a vocabulary, by hierarchical k-majority and inverse document frequency.
//!
//! The same descriptors, settings and seed give the same vocabulary, to the byte: all arithmetic but the final
//! logarithm is on whole numbers.

mod cluster;
mod error;
mod hierarchy;
mod majority;
mod set;

pub use self::error::TrainError;
pub use self::hierarchy::{Progress, TrainSettings, train};
pub use self::set::TrainingSet;
