//! The shapes, the reader, the API document's examples and the limits say the same.

use std::fmt::Debug;

use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::{Value, json};

use super::anchor::{AnchorPatch, AnchorPatchBody, AnchorView, LocalAnchorMap};
use super::decoding::read::{self, Decode};
use super::keyframe::{KeyframeAnswer, KeyframeBody, KeyframeView};
use super::list::{AnchorList, CovisibleList, KeyframeList, LoopList, MapList};
use super::loop_query::LoopQueryBody;
use super::loops::{LoopBody, LoopClosed, LoopRevoked};
use super::map::{MapBody, MapPatchBody, MapView};
use super::poses::{PosesAnswer, PosesBody};
use super::{bulk, event, examples, keyframe, problem, semantics, usage, verdict};
use crate::domain::map::MapProperties;
use crate::domain::request::{LoopQuery, MapPatch, NewLoop, PoseCorrection};

fn is_shape<T: Serialize + DeserializeOwned>(example: &Value) {
    let shape: T =
        serde_json::from_value(example.clone()).unwrap_or_else(|error| panic!("{error}: {example}"));
    assert_eq!(serde_json::to_value(shape).expect("JSON"), *example);
}

fn is_body<Shape: Serialize + DeserializeOwned, Model: Decode + Debug>(example: &Value) {
    is_shape::<Shape>(example);
    read::decode::<Model>(example).unwrap_or_else(|errors| panic!("{errors:#?}: {example}"));
}

#[test]
fn the_example_of_each_body_is_of_its_shape_and_is_read() {
    is_body::<MapBody, MapProperties>(&examples::map_body());
    is_body::<MapPatchBody, MapPatch>(&examples::map_patch());
    is_body::<LoopQueryBody, LoopQuery>(&examples::loop_query());
    is_body::<LoopBody, NewLoop>(&examples::loop_body());
    is_body::<PosesBody, PoseCorrection>(&examples::poses_body());
    is_body::<AnchorPatchBody, AnchorPatch>(&examples::anchor_patch());
    is_body::<semantics::TextPair, semantics::TextPair>(&examples::text_pair());
    is_body::<semantics::OneText, semantics::OneText>(&examples::one_text());
    is_shape::<KeyframeBody>(&examples::keyframe_body());
    let id = "kf-120".parse().expect("an id");
    let sent = keyframe::named(&examples::keyframe_body(), &id).expect("a keyframe").keyframe;
    assert_eq!(sent.observes, [12, 13]);
    assert_eq!(sent.features.expect("features").map_points, [Some(12), None]);
    for line in examples::bulk_lines() {
        bulk::decode(line).expect("a keyframe");
    }
}

#[test]
fn the_example_of_each_answer_is_of_its_shape() {
    is_shape::<MapView>(&examples::map());
    is_shape::<MapList>(&examples::maps());
    is_shape::<KeyframeAnswer>(&examples::keyframe_answer());
    is_shape::<KeyframeView>(&examples::keyframe());
    is_shape::<KeyframeList>(&examples::keyframes());
    is_shape::<bulk::BulkLine>(&examples::bulk_line());
    is_shape::<CovisibleList>(&examples::covisible());
    is_shape::<LocalAnchorMap>(&examples::local_anchor_map());
    is_shape::<PosesAnswer>(&examples::poses_answer());
    is_shape::<AnchorView>(&examples::anchor());
    is_shape::<AnchorList>(&examples::anchors());
    is_shape::<verdict::LoopAnswer>(&examples::loop_answer());
    is_shape::<LoopClosed>(&examples::loop_closed());
    is_shape::<LoopRevoked>(&examples::loop_revoked());
    is_shape::<LoopList>(&examples::loops());
    is_shape::<event::EventView>(&examples::event());
    is_shape::<semantics::LevelAnswer>(&examples::similarity());
    is_shape::<semantics::LevelAnswer>(&examples::information());
    is_shape::<semantics::MergeAnswer>(&examples::merged_text());
    is_shape::<usage::Usage>(&examples::usage());
    is_shape::<problem::ProblemView>(&examples::problem());
}

fn faults(body: &Value) -> Vec<String> {
    let id = "kf-120".parse().expect("an id");
    let errors = keyframe::named(body, &id).err().unwrap_or_default();
    errors.into_iter().map(|error| error.pointer).collect()
}

/// Changes one place of the example keyframe and expects exactly these faults.
#[track_caller]
fn check(place: &str, value: Value, expected: &[&str]) {
    let mut body = examples::keyframe_body();
    *body.pointer_mut(place).unwrap_or_else(|| panic!("{place}")) = value;
    assert_eq!(faults(&body), expected, "{place}");
}

#[test]
fn each_fault_of_a_keyframe_is_told_at_its_place() {
    check("/stamp/sec", json!("1"), &["/stamp/sec"]);
    check("/stamp/nanosec", json!(1_000_000_000), &["/stamp/nanosec"]);
    check("/pose/translation/x", json!(1e39), &["/pose/translation/x"]);
    check("/pose/rotation/w", json!(0), &["/pose/rotation"]);
    check("/camera/fx", json!(0), &["/camera/fx"]);
    check("/bow/words", json!([3, 3]), &["/bow/words/1"]);
    check("/bow/words", json!([3]), &["/bow/weights"]);
    check("/bow/words/0", json!(4_294_967_296_u64), &["/bow/words/0"]);
    check("/bow/weights/1", json!(-0.5), &["/bow/weights/1"]);
    check("/features/descriptor_bytes", json!(12), &["/features/descriptor_bytes"]);
    check("/features/descriptors", json!("%%"), &["/features/descriptors"]);
    check("/features/descriptors", json!("AAEC"), &["/features/descriptors"]);
    check("/features/keypoints/0", json!([1]), &["/features/keypoints/0"]);
    check("/features/keypoints/1/2", json!(2.5), &["/features/keypoints/1/2"]);
    check("/features/map_points", json!([-2]), &["/features/map_points/0", "/features/map_points"]);
    check("/map_points/ids", json!([12, 12]), &["/map_points/ids/1"]);
    check("/map_points/positions/0", json!([1, 2]), &["/map_points/positions/0"]);
    check("/observes/0", json!(1.5), &["/observes/0"]);
    check("/covisible/0/keyframe", json!("kf-120"), &["/covisible/0/keyframe"]);
    check("/covisible/0/keyframe", json!("x".repeat(129)), &["/covisible/0/keyframe"]);
    check("/detections/0/class", json!(" "), &["/detections/0/class"]);
    check("/detections/0/confidence", json!(1.01), &["/detections/0/confidence"]);
    check("/detections/0/box", json!([10, 0, 5, 1]), &["/detections/0/box"]);
    check("/detections/0/crop", json!("AAAA"), &["/detections/0/crop"]);
    check("/camera", Value::Null, &["/camera"]);
}

#[test]
fn all_faults_of_a_body_are_told_at_once() {
    let body = json!({
        "pose": {"translation": {"x": "a", "y": 0, "z": 0}, "rotation": {"x": 0, "y": 0, "z": 0, "w": 0}},
        "bow": {"words": [1, 1], "weights": [1]},
        "a/b~c": 1
    });
    let expected =
        ["/a~1b~0c", "/stamp", "/pose/translation/x", "/pose/rotation", "/bow/words/1", "/bow/weights"];
    assert_eq!(faults(&body), expected);
}

#[test]
fn faults_beyond_a_hundred_are_counted() {
    let mut body = examples::keyframe_body();
    body["observes"] = json!(vec!["x"; 1000]);
    let errors = keyframe::named(&body, &"kf".parse().expect("an id")).expect_err("faults");
    assert_eq!(errors.len(), 101);
    assert_eq!(errors[100].detail, "900 more faults are not listed");
}

#[test]
fn a_bulk_line_is_the_body_of_a_put_with_its_id() {
    let id = "kf-120".parse().expect("an id");
    let mut line = examples::keyframe_body();
    line["id"] = json!("kf-120");
    assert_eq!(bulk::decode(line), Ok(keyframe::named(&examples::keyframe_body(), &id).unwrap()));
    let errors = bulk::decode(json!({"id": "a/b", "pose": 1})).expect_err("faults");
    let pointers: Vec<_> = errors.faults.iter().map(|error| error.pointer.as_str()).collect();
    assert_eq!(pointers, ["/id", "/stamp", "/pose"]);
}
