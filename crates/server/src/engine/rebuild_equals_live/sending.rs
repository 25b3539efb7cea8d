//! Requests of the law, sent to the engine.

use super::requests::{CLASSES, Request, SETTINGS, TEXTS, bare, detection, keyframe_id, plate, point};
use crate::domain::bow::BowVector;
use crate::domain::change::{Change, MissedSign, MovedObservation};
use crate::domain::global_descriptor::{GlobalDescriptor, GlobalEncoding};
use crate::domain::ids::{AnchorSeq, KeyframeSeq, MapId};
use crate::domain::judged::{Answer, CropRead, CropReading, Finding, ModelVerdict, TranscriptStep};
use crate::domain::judgement::{JudgementProgress, Tally};
use crate::domain::keyframe::{CLIENTS_VOCABULARY, NewKeyframe};
use crate::domain::prior::{AnchorKey, NewPrior};
use crate::domain::request::{ChangedKeyframe, ChangedObservations, MapPatch, NewLoop, PoseCorrection};
use crate::domain::session_merge::{Renumbering, SessionMergeRequest};
use crate::engine::maps::live::Decision;
use crate::engine::{Service, ServiceError};
use crate::geometry::{Gravity, Point3, Pose, Sim3};
use crate::recognition::anchors::apply_model_answer::{learn_away, learn_reading, learn_verdict};
use crate::recognition::anchors::rejudging::rejudge;
use crate::recognition::map::index::MapIndex;
use crate::recognition::map::recorder::Recorder;
use crate::semantics::Text;

/// Sends a request as a client, or as the background work that makes it.
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
                // Its own name stands for a list that says none.
                covisible: covisible.map(|other| {
                    Some(other)
                        .filter(|other| *other != name)
                        .map(|other| (keyframe_id(other), 7))
                        .into_iter()
                        .collect()
                }),
                detections: detections.iter().map(detection).collect(),
                ..bare(name)
            };
            service.put_keyframe(map, keyframe, [name; 32]).await.map(drop)
        }
        Request::Sensed { name, tilt, descriptor } => {
            let (sin, cos) = (f64::from(tilt) * 0.1).sin_cos();
            let keyframe = NewKeyframe {
                gravity: Gravity::new([sin, cos, 0.0]),
                height_m: Some(f64::from(tilt) * 3.5),
                global_descriptor: Some(GlobalDescriptor {
                    model: "law".parse().unwrap(),
                    encoding: GlobalEncoding::Int8,
                    data: descriptor.into(),
                }),
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
        Request::Observe { session, replaced, removed, keyframe } => {
            // As a body is read: no point is fused twice or into itself, and what goes is observed no more.
            let mut fused: Vec<(i64, i64)> = Vec::new();
            for (old, new) in replaced {
                if old < new && fused.iter().all(|(known, _)| *known != old) {
                    fused.push((old, new));
                }
            }
            let removed: Vec<i64> =
                removed.into_iter().filter(|id| fused.iter().all(|(old, _)| old != id)).collect();
            let stays = |id: &i64| fused.iter().all(|(old, _)| old != id) && !removed.contains(id);
            let changed = keyframe.map(|(name, observes, other)| ChangedKeyframe {
                keyframe: keyframe_id(name),
                observes: observes.map(|mut observes| {
                    observes.sort_unstable();
                    observes.dedup();
                    observes.retain(stays);
                    observes
                }),
                covisible: other
                    .filter(|other| *other != name)
                    .map(|other| (keyframe_id(other), 9))
                    .into_iter()
                    .collect(),
            });
            let changed = ChangedObservations {
                session: format!("robot-{session}").parse().unwrap(),
                keyframes: changed.into_iter().collect(),
                replaced: fused,
                removed,
            };
            service.change_observations(map, changed).await.map(drop)
        }
        Request::Merge { session, numbers, turned } => {
            let name = |session: u8| format!("robot-{session}").parse().unwrap();
            let pose = Pose::new([3.0, -1.0, 0.5], [0.0, 0.0, 0.6, 0.8]).unwrap();
            let merge = SessionMergeRequest {
                session: name(session),
                into: name(1 - session),
                into_from_session: if turned { Sim3::scaled(pose, 1.5) } else { Sim3::identity() },
                map_points: match numbers {
                    None => Renumbering::Same,
                    Some(Ok(offset)) => Renumbering::Offset(offset),
                    Some(Err(mut pairs)) => {
                        pairs.sort_by_key(|(old, _)| *old);
                        pairs.dedup_by_key(|(old, _)| *old);
                        Renumbering::Listed(pairs)
                    }
                },
            };
            service.merge_sessions(map, merge).await.map(drop)
        }
        Request::RevokeMerge(session) => {
            service.revoke_merge(map, format!("robot-{session}").parse().unwrap()).await.map(drop)
        }
        Request::Confirm { name, keyframe, candidate } => {
            let new = NewLoop {
                id: format!("loop-{name}").parse().unwrap(),
                keyframe: keyframe_id(keyframe),
                candidate: keyframe_id(candidate),
                query: None,
                candidate_from_query: Pose::new([f64::from(name), 0.5, 0.0], [0.0, 0.6, 0.0, 0.8])
                    .filter(|_| name % 2 == 0)
                    .map(Sim3::from),
            };
            service.confirm_loop(map, new, None).await.map(drop)
        }
        Request::Revoke(name) => {
            service.revoke_loop(map, &format!("loop-{name}").parse().unwrap()).await.map(drop)
        }
        Request::PutPrior { name, frame, class, text, at: (x, y) } => {
            let frame = ["robot-0", "plan:1", "plan:2"][usize::from(frame)];
            let prior = NewPrior {
                id: format!("door-{name}").parse().unwrap(),
                class: CLASSES[usize::from(class)].to_owned(),
                description: TEXTS[usize::from(text)].to_owned(),
                position_in_frame: Point3::new(f64::from(x) * 0.7, f64::from(y) * 1.3, 1.5),
                frame: frame.parse().unwrap(),
                normal_in_frame: (x > 0).then_some([0.6, 0.8, 0.0]),
                source: (y > 0).then(|| "a plan".to_owned()),
            };
            service.put_prior(map, prior).await.map(drop)
        }
        Request::DeletePrior(name) => {
            let key: AnchorKey = format!("door-{name}").parse().unwrap();
            service.delete_anchor(map, key, None).await.map(drop)
        }
        Request::Describe(anchor, text) => {
            let text = text.map(|text| TEXTS[usize::from(text)].to_owned());
            service.describe_anchor(map, AnchorSeq(anchor).into(), None, text).await.map(drop)
        }
        Request::DeleteAnchor(anchor) => {
            service.delete_anchor(map, AnchorSeq(anchor).into(), None).await.map(drop)
        }
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
                let read = CropRead { anchor, keyframe, detection, reading, transcript, fingerprint };
                learn_reading(index, read)
            };
            service.learn(&live, move |index| Ok(learn(index))).await.expect("a change");
            Ok(())
        }
        Request::Judge { class, a, b, finding } => {
            let live = service.live(map).await?;
            let verdict = verdict(class, a, b, finding);
            service.learn(&live, move |index| Ok(learn_verdict(index, verdict))).await.expect("a change");
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
                Ok(Some(rejudge(index, reading.into_iter().chain([verdict]).collect(), progress)))
            };
            service.learn(&live, learn).await.expect("a change");
            Ok(())
        }
        Request::Away(away) => {
            let live = service.live(map).await?;
            let decide = move |index: &mut MapIndex| Ok(Decision::of((), learn_away(index, away)));
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
        Request::Codes(bits) => {
            let is_one = |at: &usize| bits >> at & 1 == 1;
            let classes = (0..CLASSES.len()).filter(is_one).map(|at| CLASSES[at].to_owned()).collect();
            let patch = MapPatch { code_classes: Some(classes), ..MapPatch::default() };
            service.patch_map(map, patch).await.map(drop)
        }
        Request::Patch(setting) => {
            let (name, value) = SETTINGS[usize::from(setting)].clone();
            let gravity = Gravity::new([0.0, 1.0, f64::from(setting) * 1e-3]);
            let patch = MapPatch { gravity, settings: vec![(name.to_owned(), value)], ..MapPatch::default() };
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
