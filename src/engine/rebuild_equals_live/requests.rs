//! Requests of all kinds, drawn at random, and how each is made to a service.

use crate::domain::bow::BowVector;
use crate::domain::change::{Change, MissedSign, MovedObservation};
use crate::domain::ids::{AnchorSeq, KeyframeId, KeyframeSeq, MapId};
use crate::domain::judged::{Answer, CropRead, CropReading, Finding, ModelVerdict, TranscriptStep};
use crate::domain::judgement::{JudgementProgress, Tally};
use crate::domain::keyframe::{CLIENTS_VOCABULARY, Crop, Detection, NewKeyframe, Stamp};
use crate::domain::request::{MapPatch, NewLoop, PoseCorrection};
use crate::domain::settings::SettingValue;
use crate::engine::maps::live::Decision;
use crate::engine::{Service, ServiceError};
use crate::geometry::{Point3, Pose};
use crate::recognition::anchors::apply_model_answer::{learn_away, learn_reading, learn_verdict};
use crate::recognition::anchors::rejudging::rejudge;
use crate::recognition::map::index::MapIndex;
use crate::recognition::map::recorder::Recorder;
use crate::semantics::Text;
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
    /// A keyframe that reads as many numbers of one shape as make a numbering once a second one does.
    Plates(u8),
    Cull(u8),
    Correct {
        session: u8,
        keyframe: u8,
        shift: i8,
        points: Vec<(i64, i8)>,
    },
    Confirm {
        name: u8,
        keyframe: u8,
        candidate: u8,
    },
    Revoke(u8),
    Describe(u32, Option<u8>),
    DeleteAnchor(u32),
    Patch(u8),
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
    class: u8,
    text: Option<u8>,
    confidence: u8,
    points: Vec<i64>,
    position: Option<(i8, i8)>,
    crop: bool,
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
    let confirm = (0u8..4, 0u8..14, 0u8..14).prop_map(|(name, keyframe, candidate)| Request::Confirm {
        name,
        keyframe,
        candidate,
    });
    prop_oneof![
        10 => put,
        3 => (0u8..14).prop_map(Request::Plates),
        2 => (0u8..14).prop_map(Request::Cull),
        2 => correct,
        3 => confirm,
        1 => (0u8..4).prop_map(Request::Revoke),
        1 => (0u32..10, prop::option::of(0u8..11)).prop_map(|(anchor, text)| Request::Describe(anchor, text)),
        1 => (0u32..10).prop_map(Request::DeleteAnchor),
        1 => (0u8..8).prop_map(Request::Patch),
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
    Detection {
        class: CLASSES[usize::from(seen.class)].to_owned(),
        confidence: f64::from(seen.confidence) / 10.0,
        box_px: [1.0, 2.0, 30.0, 40.0 + f64::from(seen.confidence)],
        map_points,
        position_in_session: seen
            .position
            .map(|(x, z)| Point3::new(f64::from(x) * 0.4, 0.1, f64::from(z) * 0.7)),
        range_assumed: seen.crop,
        text: seen.text.map(|text| TEXTS[usize::from(text)].to_owned()),
        description: None,
        crop: seen.crop.then(|| Crop { media_type: "image/png", bytes: png(seen.confidence) }),
    }
}

/// Bytes that begin as a PNG file does.
pub(super) fn png(last: u8) -> Vec<u8> {
    [b"\x89PNG\r\n\x1a\n".as_slice(), &[last]].concat()
}

/// Returns a numbered plate, far from all that is there.
pub(super) fn plate(number: u8) -> Detection {
    Detection {
        class: CLASSES[1].to_owned(),
        confidence: 0.9,
        box_px: [1.0, 2.0, 30.0, 40.0],
        map_points: Vec::new(),
        position_in_session: Some(Point3::new(100.0 + 10.0 * f64::from(number), 0.0, 0.0)),
        range_assumed: false,
        text: Some(format!("7.{number:02}")),
        description: None,
        crop: None,
    }
}

/// Returns a keyframe that brings nothing.
pub(super) fn bare(name: u8) -> NewKeyframe {
    let stamp = Stamp { sec: i64::from(name), nanosec: 5 };
    let pose = Pose::new([f64::from(name) * 0.1, 0.2, 0.3], [0.0, 0.6, 0.0, 0.8]).unwrap();
    NewKeyframe { session: "robot-0".parse().unwrap(), ..NewKeyframe::at(keyframe_id(name), stamp, pose) }
}

#[expect(clippy::too_many_lines, reason = "one arm for each kind of request")]
pub(super) async fn send(service: &Service, map: &MapId, request: Request) -> Result<(), ServiceError> {
    match request {
        Request::Put { name, session, words, mut points, covisible, detections } => {
            points.sort_unstable();
            points.dedup();
            let mut words: Vec<(u32, f64)> =
                words.into_iter().map(|word| (word, f64::from(word + 1))).collect();
            words.sort_by_key(|(word, _)| *word);
            words.dedup_by_key(|(word, _)| *word);
            let keyframe = NewKeyframe {
                session: format!("robot-{session}").parse().unwrap(),
                bow: BowVector::normalised(words).unwrap(),
                vocabulary: Some(CLIENTS_VOCABULARY.into()),
                map_points: points.iter().filter(|id| **id % 3 != 0).map(|id| (*id, point(*id))).collect(),
                observes: points,
                covisible: covisible
                    .filter(|other| *other != name)
                    .map(|other| (keyframe_id(other), 7))
                    .into_iter()
                    .collect(),
                detections: detections.iter().map(detection).collect(),
                ..bare(name)
            };
            service.put_keyframe(map, keyframe, [name; 32]).await.map(drop)
        }
        Request::Plates(name) => {
            let keyframe = NewKeyframe { detections: (0..10).map(plate).collect(), ..bare(name) };
            service.put_keyframe(map, keyframe, [name; 32]).await.map(drop)
        }
        Request::Cull(name) => service.delete_keyframe(map, &keyframe_id(name)).await.map(drop),
        Request::Correct { session, keyframe, shift, points } => {
            let pose = Pose::new([f64::from(shift), 0.0, 0.5], [0.0, 0.0, 0.6, 0.8]).unwrap();
            let correction = PoseCorrection {
                session: format!("robot-{session}").parse().unwrap(),
                keyframes: vec![(keyframe_id(keyframe), pose)],
                map_points: points
                    .into_iter()
                    .map(|(id, x)| (id, Point3::new(f64::from(x), 0.0, 1.0)))
                    .collect(),
            };
            service.correct_poses(map, correction).await.map(drop)
        }
        Request::Confirm { name, keyframe, candidate } => {
            let new = NewLoop {
                id: format!("loop-{name}").parse().unwrap(),
                keyframe: keyframe_id(keyframe),
                candidate: keyframe_id(candidate),
                query: None,
            };
            service.confirm_loop(map, new).await.map(drop)
        }
        Request::Revoke(name) => {
            service.revoke_loop(map, &format!("loop-{name}").parse().unwrap()).await.map(drop)
        }
        Request::Describe(anchor, text) => {
            let text = text.map(|text| TEXTS[usize::from(text)].to_owned());
            service.describe_anchor(map, AnchorSeq(anchor), None, text).await.map(drop)
        }
        Request::DeleteAnchor(anchor) => service.delete_anchor(map, AnchorSeq(anchor), None).await.map(drop),
        Request::ReadCrop { anchor, observation, text, described, degraded } => {
            let live = service.live(map).await?;
            let learn = move |index: &mut MapIndex| {
                let anchor = AnchorSeq(anchor);
                let (keyframe, detection) =
                    *index.anchor(anchor)?.observations.keys().nth(observation.into())?;
                let reading = CropReading {
                    text: TEXTS[usize::from(text)].into(),
                    source: "model:law".into(),
                    described,
                    degraded,
                };
                let transcript = vec![TranscriptStep {
                    speaker: "model:law".into(),
                    question: "Which?".to_owned(),
                    answer: TEXTS[usize::from(text)].to_owned(),
                }];
                let fingerprint = "law".into();
                learn_reading(
                    index,
                    CropRead { anchor, keyframe, detection, reading, transcript, fingerprint },
                )
            };
            service.learn(&live, learn).await.expect("a change");
            Ok(())
        }
        Request::Judge { class, a, b, finding } => {
            let live = service.live(map).await?;
            let verdict = verdict(class, a, b, finding);
            service.learn(&live, move |index| learn_verdict(index, verdict)).await.expect("a change");
            Ok(())
        }
        Request::JudgeAgain { anchor, observation, texts: (read, a, b), finding } => {
            let live = service.live(map).await?;
            let learn = move |index: &mut MapIndex| {
                let anchor = AnchorSeq(anchor);
                let at = index
                    .anchor(anchor)
                    .and_then(|anchor| anchor.observations.keys().nth(observation.into()).copied());
                let reading = at.map(|(keyframe, detection)| {
                    let (text, source) = (TEXTS[usize::from(read)].into(), "model:again".into());
                    let reading = CropReading { text, source, described: true, degraded: false };
                    let (transcript, fingerprint) = (Vec::new(), "again".into());
                    Answer::Reading(CropRead {
                        anchor,
                        keyframe,
                        detection,
                        reading,
                        transcript,
                        fingerprint,
                    })
                });
                let verdict = Answer::Verdict(verdict(0, a, b, finding));
                let (tally, position) = (Tally::default(), None);
                let id = "again".parse().unwrap();
                let progress = JudgementProgress { id, tally, position, is_over: false };
                Some(rejudge(index, reading.into_iter().chain([verdict]).collect(), progress))
            };
            service.learn(&live, learn).await.expect("a change");
            Ok(())
        }
        Request::Away(away) => {
            let live = service.live(map).await?;
            let decide = move |index: &mut MapIndex| {
                Ok(match learn_away(index, away) {
                    Some(decided) => Decision::Changed((), decided, None),
                    None => Decision::Unchanged(()),
                })
            };
            service.change(&live, decide).await.map(drop)
        }
        Request::ChangeSign { kind, anchor, keyframe, other } => {
            let live = service.live(map).await?;
            let (anchor, keyframe, other) = (AnchorSeq(anchor), KeyframeSeq(keyframe), other.map(AnchorSeq));
            let decide = move |index: &mut MapIndex| {
                let mut record = Recorder::new(index);
                let changes = changes_of_sign(record.index(), kind, anchor, keyframe, other);
                record.apply(changes);
                Ok(Decision::Changed((), record.finish(), None))
            };
            service.change(&live, decide).await.map(drop)
        }
        Request::Patch(setting) => {
            let (name, value) = SETTINGS[usize::from(setting)].clone();
            let patch = MapPatch { settings: vec![(name.to_owned(), value)], ..MapPatch::default() };
            service.patch_map(map, patch).await.map(drop)
        }
    }
}

pub(super) fn changes_of_sign(
    index: &MapIndex,
    kind: u8,
    anchor: AnchorSeq,
    keyframe: KeyframeSeq,
    other: Option<AnchorSeq>,
) -> Vec<Change> {
    let Some(known) = index.anchor(anchor) else { return Vec::new() };
    match kind {
        0 => vec![Change::SignMissed(MissedSign { anchor, keyframe, other })],
        1 => vec![Change::MissesWithdrawn(anchor)],
        2 => vec![Change::SignRetired(anchor, other)],
        3 => vec![Change::SignReturned(anchor)],
        _ => {
            let to = index.next_anchor();
            let moved = known.observations.keys().skip(1).map(|(keyframe, detection)| {
                let (keyframe, detection) = (*keyframe, *detection);
                Change::ObservationMoved(MovedObservation { keyframe, detection, from: anchor, to })
            });
            let moved: Vec<Change> = moved.collect();
            let added = (!moved.is_empty()).then(|| Change::AnchorAdded(to, known.class.clone()));
            added.into_iter().chain(moved).collect()
        }
    }
}

pub(super) fn verdict(class: u8, a: u8, b: u8, finding: u8) -> ModelVerdict {
    let [a, b] = [a, b].map(|text| Text::parse(TEXTS[usize::from(text)]).normalised().to_owned());
    let (a, b) = (a.clone().min(b.clone()), a.max(b));
    let (finding, b) = match finding {
        0..5 => (Finding::Similarity(finding + 1), b),
        5..10 => (Finding::Information(finding - 4), String::new()),
        _ => (Finding::Merge(format!("{a} and {b}").into()), b),
    };
    let class = CLASSES[usize::from(class)].into();
    let (source, reason, fingerprint) = ("model:law".into(), format!("{a} or {b}").into(), "law".into());
    ModelVerdict { class, a: a.into(), b: b.into(), finding, source, reason, fingerprint }
}
