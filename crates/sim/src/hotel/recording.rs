//! Recording: a tour with its truth in the format of `revisit replay`, for running it against any server.
//!
//! Poses are those of odometry: a recording cannot close loops and correct poses, because it does not receive the
//! answers.

use std::collections::BTreeSet;

use serde_json::{Value, json};

use super::method::Method;
use super::robot::message;
use super::run::{Course, odometry, session};
use super::scoring::explain::keyframe_id;
use super::scoring::truth::KeyframeIndex;
use crate::api::keyframe::BowShape;
use crate::geometry::Sim3;
use crate::vocabulary::{DescriptorMismatch, Vocabulary};

/// Returns the lines of a course: its map, and each keyframe with its query. Keyframes include their words, so that a
/// server needs no vocabulary.
pub fn recording(
    map: &str,
    course: &Course,
    vocabulary: &Vocabulary,
) -> Result<Vec<Value>, DescriptorMismatch> {
    let poses = odometry(course);
    let mut lines =
        vec![json!({"op": "map", "id": map, "body": message::map(Method::Ours, "the simulated hotel")})];
    for (at, answerable) in course.order.iter().zip(&course.answers) {
        let (step, pose) = (&course.journeys[at.0].steps[at.1], &poses[at.0][at.1]);
        let mut body = message::keyframe(Method::Ours, &session(at.0), at.1, step, &Sim3::from(*pose));
        let words =
            vocabulary.transform(vocabulary.descriptor_bytes(), &message::descriptor_bytes(step), 0)?.words;
        let (words, weights): (Vec<u32>, Vec<f64>) = words.entries().iter().copied().unzip();
        body.bow = Some(BowShape { words, weights, vocabulary: None });
        let id = keyframe_id(*at);
        lines.push(json!({"op": "keyframe", "id": id, "body": body}));
        let ids = |keyframes: &BTreeSet<KeyframeIndex>| -> Vec<String> {
            keyframes.iter().copied().map(keyframe_id).collect()
        };
        let (truth, ignore) = (ids(&answerable.truth), ids(&answerable.ignore));
        lines.push(json!({"op": "query", "keyframe": id, "body": {}, "truth": truth, "ignore": ignore}));
    }
    Ok(lines)
}
