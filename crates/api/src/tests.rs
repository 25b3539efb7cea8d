//! The shapes, the reader, the API document's examples and the limits say the same.

use std::fmt::Debug;

use revisit_core::domain::erasure::NewErasure;
use revisit_core::domain::invalid::FieldError;
use revisit_core::domain::release::NewRelease;
use revisit_core::domain::request::{
    ChangedObservations, LoopQuery, MapPatch, NewLoop, NewMap, PoseCorrection,
};
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::{Value, json};

use super::anchor::{AnchorPatchBody, AnchorView, LocalAnchorMap};
use super::decoding::base64;
use super::decoding::document::Document;
use super::decoding::read::{self, Decode};
use super::decoding::syntax;
use super::erasure::{ErasureBody, ErasureView};
use super::frames::FramesView;
use super::keyframe::{KeyframeAnswer, KeyframeBody, KeyframeView};
use super::list::{AnchorList, CovisibleList, KeyframeList, LoopList, MapList, VerdictList};
use super::loop_query::LoopQueryBody;
use super::loops::{LoopBody, LoopClosed, LoopRevoked};
use super::map::{MapBody, MapPatchBody, MapView};
use super::observations::{ObservationsAnswer, ObservationsBody};
use super::poses::{PosesAnswer, PosesBody};
use super::release::{ReleaseBody, ReleaseChangesView, ReleaseView};
use super::session_merge::{MergeBody, MergeFields, MergeRevokedAnswer, SessionsMergedAnswer};
use super::{bulk, event, examples, keyframe, problem, semantics, usage, verdict};

/// Returns the document of a value, written as text.
fn document(value: &Value) -> Document<'static> {
    syntax::parse(value.to_string().leak().as_bytes()).unwrap_or_else(|error| panic!("{error:?}: {value}"))
}

fn is_shape<T: Serialize + DeserializeOwned>(example: &Value) {
    let shape: T =
        serde_json::from_value(example.clone()).unwrap_or_else(|error| panic!("{error}: {example}"));
    assert_eq!(serde_json::to_value(shape).expect("JSON"), *example);
}

fn is_body<Shape: Serialize + DeserializeOwned, Model: Decode + Debug>(example: &Value) {
    is_shape::<Shape>(example);
    read::decode::<Model>(&document(example)).unwrap_or_else(|errors| panic!("{errors:#?}: {example}"));
}

#[test]
fn the_example_of_each_body_is_of_its_shape_and_is_read() {
    is_body::<MapBody, NewMap>(&examples::map_body());
    is_body::<ErasureBody, NewErasure>(&examples::erasure_body());
    is_body::<ReleaseBody, NewRelease>(&examples::release_body());
    is_body::<MapPatchBody, MapPatch>(&examples::map_patch());
    is_body::<LoopQueryBody, LoopQuery>(&examples::loop_query());
    is_body::<LoopBody, NewLoop>(&examples::loop_body());
    is_body::<PosesBody, PoseCorrection>(&examples::poses_body());
    is_body::<ObservationsBody, ChangedObservations>(&examples::observations_body());
    is_body::<MergeBody, MergeFields>(&examples::merge_body());
    is_body::<AnchorPatchBody, AnchorPatchBody>(&examples::anchor_patch());
    is_body::<semantics::TextPair, semantics::TextPair>(&examples::text_pair());
    is_body::<semantics::OneText, semantics::OneText>(&examples::one_text());
    is_shape::<KeyframeBody>(&examples::keyframe_body());
    let id = "kf-120".parse().expect("an id");
    let body = document(&examples::keyframe_body());
    let sent = keyframe::named(body.root(), &id).expect("a keyframe").keyframe;
    assert_eq!(sent.observes, [12, 13]);
    assert_eq!(sent.features.expect("features").map_points, [Some(12), None]);
    for line in examples::bulk_lines() {
        bulk::decode(document(&line).root()).expect("a keyframe");
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
    is_shape::<ObservationsAnswer>(&examples::observations_answer());
    is_shape::<SessionsMergedAnswer>(&examples::sessions_merged());
    is_shape::<ErasureView>(&examples::erasure());
    is_shape::<ReleaseView>(&examples::release());
    is_shape::<ReleaseChangesView>(&examples::release_changes());
    is_shape::<FramesView>(&examples::frames());
    is_shape::<MergeRevokedAnswer>(&examples::merge_revoked());
    is_shape::<AnchorView>(&examples::anchor());
    is_shape::<AnchorList>(&examples::anchors());
    is_shape::<verdict::LoopAnswer>(&examples::loop_answer());
    is_shape::<LoopClosed>(&examples::loop_closed());
    is_shape::<LoopRevoked>(&examples::loop_revoked());
    is_shape::<LoopList>(&examples::loops());
    is_shape::<VerdictList>(&examples::verdicts());
    is_shape::<event::EventView>(&examples::event());
    is_shape::<semantics::LevelAnswer>(&examples::similarity());
    is_shape::<semantics::LevelAnswer>(&examples::information());
    is_shape::<semantics::MergeAnswer>(&examples::merged_text());
    is_shape::<usage::Usage>(&examples::usage());
    is_shape::<problem::ProblemView>(&json!({
        "type": "/docs#problem-invalid",
        "title": "The body does not mean what it should",
        "status": 422,
        "detail": "2 fields are wrong",
        "code": "invalid",
        "request_id": "6c0f2a9e51d34b77-1f",
        "errors": [
            {"pointer": "/pose/rotation", "detail": "not a unit quaternion: its norm is 0",
             "got": "an object of 4 fields", "limit": "a norm of 1, within 1 %"},
            {"pointer": "/stamp", "detail": "the field is required"}
        ]
    }));
}

fn faults(body: &Value) -> Vec<String> {
    let id = "kf-120".parse().expect("an id");
    let errors = keyframe::named(document(body).root(), &id).err().unwrap_or_default();
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
    check("/gravity", json!([0, 9.81, 0]), &["/gravity/1"]);
    check("/gravity", json!([0, 0.998, 0]), &["/gravity"]);
    check("/gravity", json!([0, 1]), &["/gravity"]);
    check("/global_descriptor/model", json!("a/b"), &["/global_descriptor/model"]);
    check("/global_descriptor/encoding", json!("float32"), &["/global_descriptor/encoding"]);
    check("/global_descriptor/data", json!(""), &["/global_descriptor/data"]);
    check("/global_descriptor/data", json!("AAAA".repeat(353)), &["/global_descriptor/data"]);
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
    let body = document(&body);
    let errors = keyframe::named(body.root(), &"kf".parse().expect("an id")).expect_err("faults");
    assert_eq!(errors.len(), 101);
    assert_eq!(errors[100].detail, "900 more faults are not listed");
}

/// Packs each column of the example keyframe.
fn packed_keyframe() -> Value {
    let pack = |bytes: Vec<Vec<u8>>| json!(base64::encode(&bytes.concat()));
    let of_f64 = |numbers: &[f64]| pack(numbers.iter().map(|x| x.to_le_bytes().to_vec()).collect());
    let of_f32 = |numbers: &[f32]| pack(numbers.iter().map(|x| x.to_le_bytes().to_vec()).collect());
    let of_i64 = |numbers: &[i64]| pack(numbers.iter().map(|x| x.to_le_bytes().to_vec()).collect());
    let mut body = examples::keyframe_body();
    let lists = body.clone();
    let floats =
        |at: &Value| at.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect::<Vec<f64>>();
    let wholes =
        |at: &Value| at.as_array().unwrap().iter().map(|x| x.as_i64().unwrap()).collect::<Vec<i64>>();
    let rows = |at: &Value| at.as_array().unwrap().iter().map(floats).collect::<Vec<_>>();
    let words: Vec<Vec<u8>> =
        wholes(&lists["bow"]["words"]).iter().map(|word| (*word as u32).to_le_bytes().to_vec()).collect();
    let keypoints = rows(&lists["features"]["keypoints"]).into_iter().flat_map(|row| {
        [row[0], row[1], row.get(2).copied().unwrap_or(0.0), row.get(3).copied().unwrap_or(f64::NAN)]
    });
    let mut replace = |object: &str, list: &str, packed: &str, value: Value| {
        let of = if object.is_empty() { &mut body } else { &mut body[object] };
        of.as_object_mut().unwrap().remove(list).unwrap_or_else(|| panic!("{object} has no {list}"));
        of[packed] = value;
    };
    replace("bow", "words", "words_u32", pack(words));
    replace("bow", "weights", "weights_f64", of_f64(&floats(&lists["bow"]["weights"])));
    let keypoints: Vec<f32> = keypoints.map(|x| x as f32).collect();
    replace("features", "keypoints", "keypoints_f32", of_f32(&keypoints));
    let of_features = wholes(&lists["features"]["map_points"]);
    replace("features", "map_points", "map_points_i64", of_i64(&of_features));
    replace("map_points", "ids", "ids_i64", of_i64(&wholes(&lists["map_points"]["ids"])));
    let positions = rows(&lists["map_points"]["positions"]).concat();
    replace("map_points", "positions", "positions_f64", of_f64(&positions));
    replace("", "observes", "observes_i64", of_i64(&wholes(&lists["observes"])));
    body
}

#[test]
fn packed_columns_make_the_same_facts_and_the_same_digest_as_lists() {
    let id = "kf-120".parse().expect("an id");
    let read = |body: &Value| keyframe::named(document(body).root(), &id).expect("a keyframe");
    assert_eq!(read(&packed_keyframe()), read(&examples::keyframe_body()));
}

#[test]
fn the_digest_is_of_the_facts_whatever_their_order_and_changes_with_each_of_them() {
    let id = "kf-120".parse().expect("an id");
    let digest = |body: &Value| keyframe::named(document(body).root(), &id).expect("a keyframe").digest;
    let body = examples::keyframe_body();
    let mut reordered = body.clone();
    for list in ["/observes", "/map_points/ids", "/map_points/positions", "/bow/words", "/bow/weights"] {
        reordered.pointer_mut(list).and_then(Value::as_array_mut).expect("a list").reverse();
    }
    assert_eq!(digest(&reordered), digest(&body));
    let changes = [
        ("/session", json!("another")),
        ("/stamp/nanosec", json!(7)),
        ("/pose/translation/x", json!(0.123)),
        ("/camera/width", json!(641)),
        ("/gravity", json!([0, 0, 1])),
        ("/global_descriptor/model", json!("another")),
        ("/global_descriptor/encoding", json!("bits")),
        ("/global_descriptor/data", json!("AP8Cf4EDBPs=")),
        ("/bow/weights/0", json!(0.9)),
        ("/features/keypoints/0/0", json!(1.5)),
        ("/features/map_points/0", json!(13)),
        ("/map_points/positions/0/0", json!(7.5)),
        ("/observes/0", json!(99)),
        ("/covisible/0/shared", json!(1)),
        ("/covisible", json!([])),
        ("/detections/0/text", json!("another")),
    ];
    for (place, value) in changes {
        let mut changed = body.clone();
        *changed.pointer_mut(place).unwrap_or_else(|| panic!("{place}")) = value;
        assert_ne!(digest(&changed), digest(&body), "{place}");
    }
}

#[test]
fn the_form_of_the_digest_never_changes() {
    use std::fmt::Write as _;
    let id = "kf-120".parse().expect("an id");
    let body = examples::keyframe_body();
    let digest = keyframe::named(document(&body).root(), &id).expect("a keyframe").digest;
    let hex = digest.iter().fold(String::new(), |mut hex, byte| {
        let _ = write!(hex, "{byte:02x}");
        hex
    });
    assert_eq!(hex, "1b80ee8331b6d61803d53d19990717cc61bf889d882d39777dd4fa1b514b7d23");
}

#[test]
fn a_fault_within_a_packed_column_names_the_field_and_the_item() {
    let check = |place: &str, numbers: &[u8], pointer: &str, detail: &str| {
        let mut body = packed_keyframe();
        *body.pointer_mut(place).unwrap_or_else(|| panic!("{place}")) = json!(base64::encode(numbers));
        let id = "kf-120".parse().expect("an id");
        let errors = keyframe::named(document(&body).root(), &id).expect_err("faults");
        let is_told = |error: &FieldError| error.pointer == pointer && error.detail.contains(detail);
        assert!(errors.iter().any(is_told), "{place}: {errors:?}");
    };
    check("/bow/words_u32", &[3, 0, 0], "/bow/words_u32", "the last item is not whole");
    check("/bow/words_u32", &[3, 0, 0, 0, 3, 0, 0, 0], "/bow/words_u32", "item 1: listed twice");
    check("/bow/words_u32", &[3, 0, 0, 0], "/bow/weights_f64", "must be as long as words_u32");
    let nan = [f64::NAN.to_le_bytes(), 1_f64.to_le_bytes()].concat();
    check("/bow/weights_f64", &nan, "/bow/weights_f64", "item 0: the number is out of range");
    let wide = [1_f32, f32::INFINITY, 0.0, f32::NAN, 1.0, 2.0, 0.5, 0.0].map(f32::to_le_bytes).concat();
    check(
        "/features/keypoints_f32",
        &wide,
        "/features/keypoints_f32",
        "item 0/1: the number is out of range",
    );
    check("/features/keypoints_f32", &wide, "/features/keypoints_f32", "item 1/2: expected a whole number");
    check("/observes_i64", &(-1_i64).to_le_bytes(), "/observes_i64", "item 0: the number is out of range");
    let mut both = packed_keyframe();
    both["observes"] = json!([]);
    check_faults(&both, &["/observes_i64"]);
    both["observes_i64"] = json!(5);
    check_faults(&both, &["/observes_i64"]);
}

#[track_caller]
fn check_faults(body: &Value, expected: &[&str]) {
    assert_eq!(faults(body), expected);
}

#[test]
fn a_bulk_line_is_the_body_of_a_put_with_its_id() {
    let id = "kf-120".parse().expect("an id");
    let mut line = examples::keyframe_body();
    line["id"] = json!("kf-120");
    let body = document(&examples::keyframe_body());
    assert_eq!(bulk::decode(document(&line).root()), Ok(keyframe::named(body.root(), &id).unwrap()));
    let wrong = document(&json!({"id": "a/b", "pose": 1}));
    let errors = bulk::decode(wrong.root()).expect_err("faults");
    let pointers: Vec<_> = errors.faults.iter().map(|error| error.pointer.as_str()).collect();
    assert_eq!(pointers, ["/id", "/stamp", "/pose"]);
}
