//! Requests of all kinds, drawn at random.

use crate::domain::ids::KeyframeId;
use crate::domain::keyframe::{Crop, Detection, NewKeyframe, Stamp};
use crate::domain::settings::SettingValue;
use crate::geometry::{Point3, Pose};
use proptest::prelude::*;

#[derive(Clone, Debug)]
pub(super) enum Request {
    Put {
        name: u8,
        session: u8,
        words: Vec<u32>,
        points: Vec<i64>,
        covisible: Option<u8>,
        detections: Vec<Seen>,
    },
    /// A keyframe with what an inertial unit and a model of images say of it.
    Sensed {
        name: u8,
        tilt: u8,
        descriptor: Vec<u8>,
    },
    /// A keyframe that reads as many numbers of one shape as make a numbering once a second one does.
    Plates(u8),
    Cull(u8),
    Correct {
        session: u8,
        keyframe: u8,
        shift: i8,
        points: Vec<(i64, i8)>,
    },
    /// The client's map has fused and culled points, and says what a keyframe observes.
    Observe {
        session: u8,
        replaced: Vec<(i64, i64)>,
        removed: Option<i64>,
        keyframe: Option<(u8, Option<Vec<i64>>, Option<u8>)>,
    },
    /// The client's maps of two sessions became one: by an offset, by single numbers, or with the numbers as they are.
    Merge {
        session: u8,
        numbers: Option<Result<i64, Vec<(i64, i64)>>>,
        turned: bool,
    },
    RevokeMerge(u8),
    Confirm {
        name: u8,
        keyframe: u8,
        candidate: u8,
    },
    Revoke(u8),
    /// A sign that a plan shows, in a plan's frame or in a robot's session, which is refused.
    PutPrior {
        name: u8,
        frame: u8,
        class: u8,
        text: u8,
        at: (i8, i8),
    },
    DeletePrior(u8),
    Describe(u32, Option<u8>),
    DeleteAnchor(u32),
    Patch(u8),
    /// Which of the two classes have codes for texts, as bits.
    Codes(u8),
    ReadCrop {
        anchor: u32,
        observation: u8,
        text: u8,
        described: bool,
        degraded: bool,
    },
    Judge {
        class: u8,
        a: u8,
        b: u8,
        finding: u8,
    },
    JudgeAgain {
        anchor: u32,
        observation: u8,
        texts: (u8, u8, u8),
        finding: u8,
    },
    Away(bool),
    /// One of the changes that follow when a sign is not seen where it should be.
    ChangeSign {
        kind: u8,
        anchor: u32,
        keyframe: u32,
        other: Option<u32>,
    },
}

#[derive(Clone, Debug)]
pub(super) struct Seen {
    pub(super) class: u8,
    pub(super) text: Option<u8>,
    pub(super) confidence: u8,
    pub(super) points: Vec<i64>,
    pub(super) position: Option<(i8, i8)>,
    pub(super) crop: bool,
}

pub(super) const TEXTS: [&str; 12] = [
    "901",
    "room 901",
    "910",
    "9O1",
    "EXIT",
    "exit",
    "unknown",
    "a painting of a red boat",
    "HUB 10",
    "a ship in a storm at dawn",
    "the stormy ship of Turner",
    "",
];
pub(super) const CLASSES: [&str; 2] = ["door_number", "sign"];
pub(super) const SETTINGS: [(&str, SettingValue); 8] = [
    ("learned_identifiers", SettingValue::Switch(false)),
    ("reading_min_confidence", SettingValue::Number(0.4)),
    ("agreeing_reads", SettingValue::Count(2)),
    ("covisibility_min_shared_points", SettingValue::Count(2)),
    ("covisibility_min_shared_points", SettingValue::Count(4)),
    ("matching_min_similarity_level", SettingValue::Count(3)),
    ("description_min_information_level", SettingValue::Count(2)),
    ("association_position_radius_m", SettingValue::Number(2.0)),
];

pub(super) fn any_seen() -> impl Strategy<Value = Seen> {
    let points = prop::collection::vec(0i64..12, 0..4);
    let position = prop::option::of((-3i8..3, -3i8..3));
    (0u8..2, prop::option::of(0u8..11), 0u8..11, points, position, any::<bool>()).prop_map(
        |(class, text, confidence, points, position, crop)| Seen {
            class,
            text,
            confidence,
            points,
            position,
            crop,
        },
    )
}

pub(super) fn any_request() -> impl Strategy<Value = Request> {
    let put = (
        0u8..14,
        0u8..2,
        prop::collection::vec(0u32..20, 0..6),
        prop::collection::vec(0i64..12, 0..8),
        prop::option::of(0u8..14),
        prop::collection::vec(any_seen(), 0..3),
    )
        .prop_map(|(name, session, words, points, covisible, detections)| Request::Put {
            name,
            session,
            words,
            points,
            covisible,
            detections,
        });
    let correct = (0u8..2, 0u8..14, -3i8..3, prop::collection::vec((0i64..12, -5i8..5), 0..4))
        .prop_map(|(session, keyframe, shift, points)| Request::Correct { session, keyframe, shift, points });
    let observe = (
        0u8..2,
        prop::collection::vec((0i64..12, 0i64..15), 0..3),
        prop::option::of(0i64..12),
        prop::option::of((
            0u8..14,
            prop::option::of(prop::collection::vec(0i64..12, 0..8)),
            prop::option::of(0u8..14),
        )),
    )
        .prop_map(|(session, replaced, removed, keyframe)| Request::Observe {
            session,
            replaced,
            removed,
            keyframe,
        });
    let confirm = (0u8..4, 0u8..14, 0u8..14).prop_map(|(name, keyframe, candidate)| Request::Confirm {
        name,
        keyframe,
        candidate,
    });
    let listed = prop::collection::vec((0i64..12, 0i64..20), 0..4);
    let numbers = prop::option::of(prop_oneof![(0i64..9).prop_map(Ok), listed.prop_map(Err)]);
    prop_oneof![
        10 => put,
        3 => (0u8..14, 0u8..4, prop::collection::vec(any::<u8>(), 3..5))
            .prop_map(|(name, tilt, descriptor)| Request::Sensed { name, tilt, descriptor }),
        3 => (0u8..14).prop_map(Request::Plates),
        2 => (0u8..14).prop_map(Request::Cull),
        2 => correct,
        4 => observe,
        2 => (0u8..2, numbers, any::<bool>())
            .prop_map(|(session, numbers, turned)| Request::Merge { session, numbers, turned }),
        2 => (0u8..2).prop_map(Request::RevokeMerge),
        3 => confirm,
        1 => (0u8..4).prop_map(Request::Revoke),
        1 => (0u32..10, prop::option::of(0u8..11)).prop_map(|(anchor, text)| Request::Describe(anchor, text)),
        1 => (0u32..10).prop_map(Request::DeleteAnchor),
        1 => (0u8..8).prop_map(Request::Patch),
        1 => (0u8..4).prop_map(Request::Codes),
        3 => (0u32..10, 0u8..4, 0u8..12, any::<bool>(), any::<bool>()).prop_map(
            |(anchor, observation, text, described, degraded)| Request::ReadCrop {
                anchor,
                observation,
                text,
                described,
                degraded,
            }
        ),
        3 => (0u8..2, 0u8..12, 0u8..12, 0u8..12).prop_map(|(class, a, b, finding)| Request::Judge {
            class,
            a,
            b,
            finding,
        }),
        2 => (0u32..10, 0u8..4, (0u8..12, 0u8..12, 0u8..12), 0u8..12).prop_map(
            |(anchor, observation, texts, finding)| Request::JudgeAgain { anchor, observation, texts, finding }
        ),
        3 => (0u8..5, 0u8..3, 0u8..2, 0u8..11, (-3i8..3, -3i8..3)).prop_map(
            |(name, frame, class, text, at)| Request::PutPrior { name, frame, class, text, at }
        ),
        1 => (0u8..5).prop_map(Request::DeletePrior),
        1 => any::<bool>().prop_map(Request::Away),
        4 => (0u8..5, 0u32..10, 0u32..20, prop::option::of(0u32..10)).prop_map(
            |(kind, anchor, keyframe, other)| Request::ChangeSign { kind, anchor, keyframe, other }
        ),
    ]
}

pub(super) fn keyframe_id(name: u8) -> KeyframeId {
    format!("kf-{name}").parse().unwrap()
}

pub(super) fn point(id: i64) -> Point3 {
    Point3::new(id as f64 * 0.3, 1.0, 2.0)
}

pub(super) fn detection(seen: &Seen) -> Detection {
    let mut map_points = seen.points.clone();
    map_points.sort_unstable();
    map_points.dedup();
    let confidence = f64::from(seen.confidence);
    let box_px = [1.0, 2.0, 30.0, 40.0 + confidence];
    Detection {
        map_points,
        position_in_session: seen
            .position
            .map(|(x, z)| Point3::new(f64::from(x) * 0.4, 0.1, f64::from(z) * 0.7)),
        range_assumed: seen.crop,
        text: seen.text.map(|text| TEXTS[usize::from(text)].to_owned()),
        crop: seen.crop.then(|| Crop { media_type: "image/png", bytes: png(seen.confidence) }),
        ..Detection::of(CLASSES[usize::from(seen.class)], confidence / 10.0, box_px)
    }
}

/// Bytes that begin as a PNG file does.
pub(super) fn png(last: u8) -> Vec<u8> {
    [b"\x89PNG\r\n\x1a\n".as_slice(), &[last]].concat()
}

/// Returns a numbered plate, far from all that is there.
pub(super) fn plate(number: u8) -> Detection {
    Detection {
        position_in_session: Some(Point3::new(100.0 + 10.0 * f64::from(number), 0.0, 0.0)),
        text: Some(format!("7.{number:02}")),
        ..Detection::of(CLASSES[1], 0.9, [1.0, 2.0, 30.0, 40.0])
    }
}

/// Returns a keyframe that brings nothing.
pub(super) fn bare(name: u8) -> NewKeyframe {
    let stamp = Stamp { sec: i64::from(name), nanosec: 5 };
    let pose = Pose::new([f64::from(name) * 0.1, 0.2, 0.3], [0.0, 0.6, 0.0, 0.8]).unwrap();
    NewKeyframe { session: "robot-0".parse().unwrap(), ..NewKeyframe::at(keyframe_id(name), stamp, pose) }
}
