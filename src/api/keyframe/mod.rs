//! Keyframe: read from what a client sends, and answered.
//!
//! | file | concept |
//! |---|---|
//! | `shape` | the shape sent |
//! | `number_shape` | the numbers in its columns |
//! | `sent_shape` | the schemas of what may be sent packed |
//! | `decode` | the shape read into the model, with every fault in it |
//! | `features`, `detection`, `points` | its large members, read |
//! | `global_descriptor` | the vector of its whole image |
//! | `digest` | the facts that make two bodies the same |
//! | `answer` | the shapes answered |
//! | `original` | the shape sent, written again |

mod answer;
mod decode;
mod detection;
mod digest;
mod features;
mod global_descriptor;
mod number_shape;
mod original;
mod points;
mod sent_shape;
mod shape;

pub use answer::{
    CovisibleView, DetectionView, KeyframeAnswer, KeyframeLine, KeyframeView, OutcomeName, OutcomeView,
};
pub use decode::{Faulty, SentKeyframe, named, of_line, unnamed, unplaced};
pub(super) use decode::{OBSERVES, covisible};
pub use global_descriptor::GlobalDescriptorShape;
pub use number_shape::{Direction, PointNumber};
pub(super) use points::ascending;
pub use points::{points, unique};
pub use sent_shape::{SentBow, SentFeatures, SentPoints};
pub use shape::{
    BowShape, CameraShape, CovisibleShape, DetectionShape, FeaturesShape, KeyframeBody, PointsShape,
    RangeName,
};
