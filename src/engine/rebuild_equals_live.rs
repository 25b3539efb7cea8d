//! The law of the house: an index built from the store equals the live one, after any requests.

mod exported;

use std::collections::BTreeMap;
use std::sync::Arc;

use futures_util::future::BoxFuture;
use proptest::prelude::*;
use sqlx::sqlite::SqliteConnectOptions;
use sqlx::{AssertSqlSafe, ConnectOptions as _, Executor as _};

use super::maps::live::Decision;
use super::service::Parts;
use super::{Service, ServiceError, ServiceOptions};
use crate::config::models::ModelArgs;
use crate::domain::bow::BowVector;
use crate::domain::change::{Change, MissedSign, MovedObservation};
use crate::domain::ids::{AnchorSeq, KeyframeId, KeyframeSeq, MapId};
use crate::domain::judged::{Answer, CropRead, CropReading, Finding, ModelVerdict, TranscriptStep};
use crate::domain::judgement::{JudgementProgress, Tally};
use crate::domain::keyframe::{CLIENTS_VOCABULARY, Crop, Detection, NewKeyframe, Stamp};
use crate::domain::map::{MapFigures, MapProperties};
use crate::domain::request::{LoopQuery, MapPatch, NewLoop, PoseCorrection, Subject};
use crate::domain::roles::Roles;
use crate::domain::settings::SettingValue;
use crate::domain::verdict::{ReasonCode, Verify};
use crate::geometry::{Point3, Pose};
use crate::integrity::rebuild::rebuild;
use crate::llm::Models;
use crate::llm::port::{Fault, Model, Question, Reply};
use crate::recognition::anchors::apply_model_answer::{learn_away, learn_reading, learn_verdict};
use crate::recognition::anchors::rejudging::rejudge;
use crate::recognition::map::index::MapIndex;
use crate::recognition::map::recorder::Recorder;
use crate::semantics::Text;
use crate::store::Order;

#[derive(Clone, Debug)]
enum Request {
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
struct Seen {
    class: u8,
    text: Option<u8>,
    confidence: u8,
    points: Vec<i64>,
    position: Option<(i8, i8)>,
    crop: bool,
}

const TEXTS: [&str; 12] = [
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
const CLASSES: [&str; 2] = ["door_number", "sign"];
const SETTINGS: [(&str, SettingValue); 8] = [
    ("learned_identifiers", SettingValue::Switch(false)),
    ("reading_min_confidence", SettingValue::Number(0.4)),
    ("agreeing_reads", SettingValue::Count(2)),
    ("covisibility_min_shared_points", SettingValue::Count(2)),
    ("covisibility_min_shared_points", SettingValue::Count(4)),
    ("matching_min_similarity_level", SettingValue::Count(3)),
    ("description_min_information_level", SettingValue::Count(2)),
    ("association_position_radius_m", SettingValue::Number(2.0)),
];

fn any_seen() -> impl Strategy<Value = Seen> {
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

fn any_request() -> impl Strategy<Value = Request> {
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

fn keyframe_id(name: u8) -> KeyframeId {
    format!("kf-{name}").parse().unwrap()
}

fn point(id: i64) -> Point3 {
    Point3::new(id as f64 * 0.3, 1.0, 2.0)
}

fn detection(seen: &Seen) -> Detection {
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
fn png(last: u8) -> Vec<u8> {
    [b"\x89PNG\r\n\x1a\n".as_slice(), &[last]].concat()
}

/// Returns a numbered plate, far from all that is there.
fn plate(number: u8) -> Detection {
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
fn bare(name: u8) -> NewKeyframe {
    let stamp = Stamp { sec: i64::from(name), nanosec: 5 };
    let pose = Pose::new([f64::from(name) * 0.1, 0.2, 0.3], [0.0, 0.6, 0.0, 0.8]).unwrap();
    NewKeyframe { session: "robot-0".parse().unwrap(), ..NewKeyframe::at(keyframe_id(name), stamp, pose) }
}

#[expect(clippy::too_many_lines, reason = "one arm for each kind of request")]
async fn send(service: &Service, map: &MapId, request: Request) -> Result<(), ServiceError> {
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

fn changes_of_sign(
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

fn verdict(class: u8, a: u8, b: u8, finding: u8) -> ModelVerdict {
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

async fn holds_after(requests: Vec<Request>) {
    let folder = tempfile::tempdir().unwrap();
    let database = format!("sqlite://{}/law.db", folder.path().display());
    let service = Service::open(ServiceOptions::for_tests(database)).await.unwrap();
    let map: MapId = "hotel".parse().unwrap();
    let mut properties = MapProperties { metric: true, ..MapProperties::default() };
    properties.settings.covisibility_min_shared_points = 3;
    service.put_map(map.clone(), properties, None).await.unwrap();
    for request in requests {
        let shown = format!("{request:?}");
        match send(&service, &map, request).await {
            Err(ServiceError::Internal(error)) => panic!("{shown}: {error}"),
            Err(ServiceError::Unavailable { detail, .. }) => panic!("{shown}: {detail}"),
            Ok(()) | Err(_) => {}
        }
    }
    let live = service.live(&map).await.unwrap();
    let loaded = rebuild(&service.store, &map, Order::Forwards).await.unwrap().unwrap();
    let backwards = rebuild(&service.store, &map, Order::Backwards).await.unwrap().unwrap();
    {
        let state = live.state().unwrap();
        assert_eq!(loaded.facts.version, state.version);
        pretty(&loaded.index, &state.index);
        // What `revisit check` builds to find out whether a database holds the law.
        pretty(&backwards.index, &state.index);
        // What lists of maps show, without an index.
        assert_eq!(loaded.facts.figures, state.index.figures());
        assert_eq!(loaded.facts.learned, Some(state.index.learned()));
    }
    let listed = service.get_map(&map).await.unwrap();
    assert_eq!((listed.version, &listed.properties), (loaded.facts.version, loaded.index.properties()));
    assert_eq!(listed.vocabulary.as_deref(), loaded.index.vocabulary());
    let figures = loaded.facts.figures;
    drop(live);
    let database = folder.path().join("law.db");
    until_folded(&database).await;
    service.close().await;
    assert_eq!(counted_by_the_migration(&database).await, figures);
}

/// Waits until no change is deferred, for the migration counts rows.
async fn until_folded(database: &std::path::Path) {
    let options = SqliteConnectOptions::new().filename(database).read_only(true);
    let mut db = options.connect().await.unwrap();
    let deferred = "select exists (select 1 from deferred_changes)";
    while sqlx::query_scalar::<_, bool>(deferred).fetch_one(&mut db).await.unwrap() {
        tokio::task::yield_now().await;
    }
}

/// Returns the figures of the only map as the migration that made them counts them for the maps it finds.
async fn counted_by_the_migration(database: &std::path::Path) -> MapFigures {
    let migration = include_str!("../../migrations/sqlite/0007_figures.sql");
    let (_, counting) =
        migration.split_once("\nupdate maps set\n").expect("what it does to the maps it finds");
    let options = SqliteConnectOptions::new().filename(database);
    let mut db = options.connect().await.unwrap();
    db.execute("update maps set keyframes = 99, anchors = 99, sessions = 99, loops = 99, bytes = 99")
        .await
        .unwrap();
    db.execute(AssertSqlSafe(format!("update maps set\n{counting}"))).await.unwrap();
    let select = "select keyframes, anchors, sessions, loops, bytes from maps";
    let row: (i64, i64, i64, i64, i64) = sqlx::query_as(select).fetch_one(&mut db).await.unwrap();
    let [keyframes, anchors, sessions, loops, bytes] =
        [row.0, row.1, row.2, row.3, row.4].map(|figure| figure as u64);
    MapFigures { keyframes, anchors, sessions, loops, bytes }
}

/// A difference of two whole indexes is unreadable; this names the part that differs.
fn pretty(
    loaded: &crate::recognition::map::index::MapIndex,
    live: &crate::recognition::map::index::MapIndex,
) {
    assert_eq!(loaded.properties(), live.properties());
    assert_eq!(loaded.sessions(), live.sessions());
    assert_eq!(loaded.keyframes().collect::<Vec<_>>(), live.keyframes().collect::<Vec<_>>());
    assert_eq!(loaded.loops(), live.loops());
    assert_eq!(loaded.points(), live.points());
    assert_eq!(loaded.bytes(), live.bytes());
    assert_eq!(loaded.covisibility_lists(), live.covisibility_lists());
    for seq in (0..live.next_anchor().0).map(AnchorSeq) {
        assert_eq!(loaded.anchor(seq), live.anchor(seq));
    }
    assert_eq!(loaded.readings(), live.readings());
    assert_eq!(loaded.verdicts(), live.verdicts());
    assert_eq!(loaded.model_away(), live.model_away());
    assert_eq!(loaded.objects(), live.objects());
    assert_eq!(loaded.texts(), live.texts());
    assert!(loaded == live, "another part of the index differs");
}

/// A model that fills a role and answers nothing.
#[derive(Debug)]
struct Mute {
    sees: bool,
}

impl Model for Mute {
    fn name(&self) -> &'static str {
        "mute"
    }

    fn identity(&self) -> String {
        "mute".to_owned()
    }

    fn can(&self, question: &Question) -> bool {
        question.needs_eyes() == self.sees
    }

    fn answer<'a>(&'a self, _: &'a Question) -> BoxFuture<'a, Result<Reply, Fault>> {
        Box::pin(std::future::ready(Err(Fault::Unable)))
    }
}

/// Returns the service as it would answer with models in these roles. No worker runs, so that the map stays as it is.
async fn with_roles(service: &Service, roles: Roles) -> Service {
    if roles.is_none() {
        return service.clone();
    }
    let mute = |sees: bool, wanted: bool| wanted.then(|| Arc::new(Mute { sees }) as Arc<dyn Model>);
    let models = [mute(false, roles.text), mute(true, roles.vision)];
    let models = Models::with(models, None, &ModelArgs::of(&[""; 0]).unwrap(), &service.store).await.unwrap();
    assert_eq!(models.roles(), roles);
    Service(Arc::new(Parts { models: Some(Arc::new(models)), ..Parts::clone(service) }))
}

/// One id stands for one verdict, whichever models are configured: all that a verdict depends on is in its id.
async fn one_id_is_one_verdict_after(requests: Vec<Request>) {
    let folder = tempfile::tempdir().unwrap();
    let database = format!("sqlite://{}/law.db", folder.path().display());
    let service = Service::open(ServiceOptions::for_tests(database)).await.unwrap();
    let map: MapId = "hotel".parse().unwrap();
    let mut properties = MapProperties { metric: true, ..MapProperties::default() };
    properties.settings.covisibility_min_shared_points = 3;
    service.put_map(map.clone(), properties, None).await.unwrap();
    for request in requests {
        let _ = send(&service, &map, request).await;
    }
    let mut verdicts = BTreeMap::new();
    for (vision, text) in [(false, false), (true, false), (false, true), (true, true)] {
        let service = with_roles(&service, Roles { vision, text }).await;
        for name in 0..14 {
            let subject = Subject::Stored(keyframe_id(name));
            let query = LoopQuery { subject, verify: Verify::Auto, max_wait_ms: 0, seed: 0 };
            let Ok(answer) = service.loop_query(&map, query).await else { continue };
            for candidate in &answer.verdict.candidates {
                let class = candidate.reason.as_ref().map(|reason| reason.code.words().class);
                assert!(class.is_none_or(|class| candidate.decision.fits(class)), "{candidate:?}");
            }
            let waits = answer.verdict.candidates.iter().filter_map(|c| Some(c.reason.as_ref()?.code));
            assert!(vision || waits.into_iter().all(|code| code != ReasonCode::LlmPending));
            let known = verdicts.entry(answer.id).or_insert_with(|| answer.verdict.clone());
            assert_eq!(*known, answer.verdict, "vision: {vision}, text: {text}");
        }
    }
    service.close().await;
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn a_rebuilt_index_equals_the_live_one(requests in prop::collection::vec(any_request(), 1..40)) {
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().unwrap();
        runtime.block_on(holds_after(requests));
    }

    #[test]
    fn one_id_is_one_verdict_under_any_configuration(requests in prop::collection::vec(any_request(), 1..40)) {
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().unwrap();
        runtime.block_on(one_id_is_one_verdict_after(requests));
    }
}
