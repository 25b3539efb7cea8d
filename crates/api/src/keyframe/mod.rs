//! Keyframe: read from what a client sends, and answered.
//!
//! | file | concept |
//! |---|---|
//! | `shape` | the shape sent |
//! | `keypoint`, `crop` | members with a form of their own |
//! | `decode` | the shape read into the model, with every fault in it |
//! | `global_descriptor` | the vector of its whole image |
//! | `digest` | the facts that make two bodies the same |
//! | `answer` | the shapes answered |
//! | `original` | the shape sent, written again |

mod answer;
mod crop;
mod decode;
mod digest;
mod global_descriptor;
mod keypoint;
mod original;
mod shape;

pub use answer::{
    CovisibleView, DetectionView, KeyframeAnswer, KeyframeLine, KeyframeView, OutcomeName, OutcomeView,
};
pub use decode::{Faulty, SentKeyframe, named, of_line, unnamed};
pub(super) use decode::{ascending, others_than};
pub use global_descriptor::GlobalDescriptorShape;
pub use keypoint::KeypointShape;
pub use shape::{
    BowShape, CameraShape, CovisibleShape, DetectionShape, FeaturesShape, Keyframe, KeyframeBody,
    PointsShape, RangeName, SentBagOfWords, SentFeatures, SentMapPoints,
};
pub(super) use shape::{covisible, features, filled, named_once};
