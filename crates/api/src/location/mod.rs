//! "Where am I?": the question and the answer (`openapi/openapi.yaml`).

mod answer;
mod question;

pub use answer::{AskedMapView, LocateAnswerView, LookForView, PlaceSignsView, PlaceView, UncertaintyView};
pub use question::{LocateBody, LocateExcludeBody, LocateHintBody, UnplacedKeyframeBody};
