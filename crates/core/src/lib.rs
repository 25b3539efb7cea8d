//! Semantic place recognition: is this keyframe a loop?
//!
//! The method of *Resolving Loop Closure Confusion in Repetitive Environments for Visual SLAM through AI Foundation Models
//! Assistance*, and what the server `revisit` adds to it (`docs/method.md` of its repository). Values in, values out: no IO
//! but for vocabulary files, no clock, no JSON and no threads. The same values give the same verdict, to the bit.
//!
//! | module | what it holds |
//! |---|---|
//! | [`recognition`] | the paper, section by section; its first page is the table *section, file, function* |
//! | [`domain`] | keyframes, anchors, settings, verdicts |
//! | [`semantics`] | the built-in judge of texts: InformationLevel, SimilarityLevel, MergeText (§IV-A.2) |
//! | [`vocabulary`] | descriptors to words, as DBoW2 does |
//! | [`geometry`] | poses, similarities, boxes, bearings, Hamming distances |
//!
//! # A loop, and its look-alike
//!
//! A robot sees the plate of room 901, comes back with drift, and later passes a door that looks the same:
//!
//! ```
//! use revisit_core::geometry::{Point3, Pose};
//! use revisit_core::{
//!     BowVector, Decision, Detection, FeatureSet, MapIndex, NewKeyframe, Query, Stamp, Verify, check_loop, ingest,
//! };
//!
//! fn keyframe(id: &str, sec: i64, x: f64, plate: &str) -> NewKeyframe {
//!     let pose = Pose::new([x, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]).expect("a rotation");
//!     let seen = Detection {
//!         position_in_session: Some(Point3::new(x, 0.0, 2.0)),
//!         text: Some(plate.to_owned()),
//!         ..Detection::of("door_number", 0.9, [300.0, 200.0, 340.0, 220.0])
//!     };
//!     NewKeyframe {
//!         bow: BowVector::normalised(vec![(3, 1.0), (17, 1.0), (42, 1.0)]).expect("three words"),
//!         detections: vec![seen],
//!         ..NewKeyframe::at(id.parse().expect("an id"), Stamp { sec, nanosec: 0 }, pose)
//!     }
//! }
//!
//! let mut map = MapIndex::default();
//! let first = keyframe("kf-1", 1, 0.0, "901");
//! ingest(&mut map, &first);
//!
//! let ask = |map: &MapIndex, keyframe: &NewKeyframe| {
//!     check_loop(map, &Query::inline(map, keyframe), Verify::Anchors, &FeatureSet::default(), 0)
//! };
//! let again = ask(&map, &keyframe("kf-2", 90, 5.0, "Room 901"));
//! assert_eq!(again.decision, Decision::Loop);
//! assert_eq!(again.best, Some(first.id));
//!
//! let other = ask(&map, &keyframe("kf-3", 120, 15.0, "910"));
//! assert_eq!(other.decision, Decision::NoLoop);
//! let reason = other.candidates[0].reason.as_ref().expect("a reason");
//! assert_eq!(reason.code.as_str(), "contradiction");
//! ```

// Code in a kernel that is not inlined is compiled for the plain target ([`geometry`]'s `instruction_set`).
#![allow(clippy::inline_always)]
// Expected values may be computed with the platform's own sines.
#![cfg_attr(test, allow(clippy::disallowed_methods))]

pub mod domain;
pub mod geometry;
pub mod named;
pub mod recognition;
pub mod semantics;
pub mod vocabulary;

pub use domain::bow::BowVector;
pub use domain::keyframe::{Camera, Detection, Features, Keypoint, NewKeyframe, Stamp};
pub use domain::map::MapProperties;
pub use domain::settings::Settings;
pub use domain::verdict::{Candidate, CandidateDecision, Decision, ReasonCode, Verdict, Verify};
pub use recognition::anchors::ingest::ingest;
pub use recognition::anchors::loop_closure::{close_loop, revoke_loop};
pub use recognition::anchors::observations::{ObservationsChanged, TooManyPairs, change_observations};
pub use recognition::loops::check_loop::{check_loop, screen, verify_and_decide};
pub use recognition::loops::features::{FeatureSet, MatchableFeatures};
pub use recognition::loops::query::Query;
pub use recognition::loops::wanted_features::WantedFeatures;
pub use recognition::map::correction::{Correction, correct};
pub use recognition::map::culling::cull_keyframe;
pub use recognition::map::index::MapIndex;
pub use semantics::Text;
pub use vocabulary::Vocabulary;
