//! M64, the laws of odds: what no evidence may do, whatever the scene.

use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use revisit_core::domain::settings::WithoutAnchors;
use revisit_core::recognition::odds::log_odds::LogOdds;
use revisit_core::recognition::odds::weights;
use revisit_core::{Camera, Candidate, CandidateDecision, Features, Keypoint, ReasonCode, Settings};

use super::scene::{Keyframe, Scene, Thing, code, confidence, door, keyframe, terms, thing};

/// Directions around the camera in which signs hang.
const SLOTS: usize = 9;

/// The place of a sign in this direction.
fn slot(number: usize) -> [f64; 3] {
    let angle = (number as f64 * 40.0).to_radians();
    [2.0 * angle.sin(), 0.0, 2.0 * angle.cos()]
}

/// The plate in a direction, or another one that hangs there.
fn plate(number: usize, other: bool) -> Thing {
    door(&format!("{}", if other { 1_501 } else { 901 } + 2 * number), slot(number))
}

/// A thing that a copy of a place shows as well: pictures, notices, brands, floors and generic words.
const COPIED: [&str; 10] = [
    "a painting of a sailing boat before a windmill",
    "a poster of a red balloon over snowy mountains",
    "Please keep this fire door closed at all times",
    "Prière de fermer doucement cette porte",
    "本室設備使用後請歸還原位",
    "Be Updated",
    "Library Corner, level 5",
    "kitchen, wing B",
    "EXIT",
    "brown door",
];

fn copied(number: usize, text: usize) -> Thing {
    thing("sign", COPIED[text]).at(slot(number))
}

/// A thing that hangs in a direction.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Hung {
    Nothing,
    Plate,
    OtherPlate,
    Copied(usize),
}

impl Hung {
    fn thing(self, number: usize) -> Option<Thing> {
        match self {
            Self::Nothing => None,
            Self::Plate => Some(plate(number, false)),
            Self::OtherPlate => Some(plate(number, true)),
            Self::Copied(text) => Some(copied(number, text)),
        }
    }
}

fn hung() -> impl Strategy<Value = Hung> {
    prop_oneof![
        Just(Hung::Nothing),
        Just(Hung::Plate),
        Just(Hung::OtherPlate),
        (0..COPIED.len()).prop_map(Hung::Copied),
    ]
}

fn place() -> impl Strategy<Value = Vec<Hung>> {
    prop::collection::vec(hung(), SLOTS)
}

fn things(hung: &[Hung]) -> Vec<Thing> {
    hung.iter().enumerate().filter_map(|(number, hung)| hung.thing(number)).collect()
}

/// A keyframe of a drive of its own.
fn drive(session: &str, sights: impl IntoIterator<Item = Thing>) -> Keyframe {
    keyframe().session(session).sees(sights)
}

/// An image of many points, each with a descriptor unlike the others, and where they are.
struct View {
    camera: Camera,
    features: Features,
    points: Vec<(i64, [f64; 3])>,
}

fn view(count: usize) -> View {
    let camera = Camera { fx: 500.0, fy: 500.0, cx: 320.0, cy: 240.0, width: 640, height: 480 };
    let mut random = ChaCha8Rng::seed_from_u64(7);
    let (mut points, mut keypoints) = (Vec::new(), Vec::new());
    for id in 0..count as i64 {
        let (u, v) = (random.random_range(5.0..635.0), random.random_range(5.0..475.0));
        let z = random.random_range(2.0..6.0);
        points.push((id, [(u - camera.cx) / camera.fx * z, (v - camera.cy) / camera.fy * z, z]));
        keypoints.push(Keypoint { u, v, octave: 0, angle_deg: None });
    }
    let features = Features {
        descriptor_bytes: 32,
        descriptors: (0..32 * count).map(|_| random.random_range(0..=255_u8)).collect(),
        keypoints,
        map_points: (0..count as i64).map(Some).collect(),
    };
    View { camera, features, points }
}

impl View {
    fn shown(&self, keyframe: Keyframe) -> Keyframe {
        keyframe.camera(self.camera).features(self.features.clone()).points(&self.points)
    }
}

/// Two drives past places that look the same to the last pixel.
fn seen_twice(settings: Settings, points: usize, query: Vec<Thing>, candidate: Vec<Thing>) -> Candidate {
    let view = view(points);
    let mut scene = Scene::with(settings);
    scene.put("candidate", view.shown(drive("first", candidate)));
    scene.put("query", view.shown(drive("now", query)));
    let features = ["candidate", "query"].map(|id| (id, view.features.clone()));
    scene.ask_seeing("query", &features).candidates.remove(0)
}

#[test]
fn a_view_alone_closes_a_loop_only_where_nothing_repeats() {
    for (building_repeats, decision) in
        [(false, CandidateDecision::Loop), (true, CandidateDecision::Undecided)]
    {
        let without_anchors = WithoutAnchors::Geometry;
        let settings = Settings { building_repeats, without_anchors, ..Settings::default() };
        let found = seen_twice(settings, 400, Vec::new(), Vec::new());
        assert_eq!(found.decision, decision, "{building_repeats}: {found:#?}");
    }
}

#[test]
fn a_view_does_not_lift_a_name_that_a_reader_was_not_confident_of() {
    let unsure = || vec![plate(0, false).confidence(0.6)];
    let found = seen_twice(Settings::default(), 400, unsure(), unsure());
    assert_eq!(found.decision, CandidateDecision::Undecided, "{found:#?}");
    let most = weights::NAME_DOUBTFUL + weights::NO_COPY;
    assert_eq!(terms(&found).into_iter().map(|(_, weight)| weight).sum::<LogOdds>(), most, "{found:#?}");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 128, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn log_odds_are_whole_thousandths_whose_sum_is_the_same_in_any_order(
        (naturals, shuffled) in prop::collection::vec(-50.0..50.0_f64, 0..40)
            .prop_flat_map(|naturals| (Just(naturals.clone()), Just(naturals).prop_shuffle())),
    ) {
        let sum = |naturals: &[f64]| naturals.iter().copied().map(LogOdds::of).sum::<LogOdds>();
        let total = sum(&naturals);
        prop_assert_eq!(total, sum(&shuffled));
        // It is written without loss, and so is each of its parts.
        prop_assert_eq!(LogOdds::of(total.natural()), total);
        let thousandths: i64 = naturals.iter().map(|natural| (natural * 1e3).round() as i64).sum();
        prop_assert_eq!(total, LogOdds::of_thousandths(thousandths));
    }

    #[test]
    fn a_confidence_is_the_sum_of_the_terms_that_are_shown_in_any_order(
        query in place(), one in place(), other in place(),
    ) {
        let mut scene = Scene::new();
        for (id, hung) in [("one", &one), ("other", &other), ("query", &query)] {
            scene.put(id, drive(id, things(hung)));
        }
        for found in scene.ask("query").candidates {
            let total: LogOdds = terms(&found).into_iter().rev().map(|(_, log_odds)| log_odds).sum();
            prop_assert_eq!(total.probability(), confidence(&found), "{:#?}", found);
        }
    }

    #[test]
    fn more_evidence_for_a_rival_never_raises_the_confidence_of_a_place(
        // The query sees every plate; whose else it is: nobody's, the place's, the rival's, or the rival's in the end; or
        // another plate hangs there at the place. None is both the place's and the rival's: the two may be one place then.
        owners in prop::collection::vec(0..5_usize, SLOTS),
    ) {
        let of = |wanted: usize, other: bool| {
            let owned = owners.iter().enumerate().filter(move |(_, owner)| **owner == wanted);
            owned.map(move |(number, _)| plate(number, other))
        };
        let mut scene = Scene::new();
        scene.put("place", drive("first", of(1, false).chain(of(4, true))));
        scene.put("query", drive("now", (0..SLOTS).map(|number| plate(number, false))));
        let mut last = confidence(&scene.compare("query", "place"));
        let few: Vec<Thing> = of(2, false).collect();
        let more: Vec<Thing> = few.iter().cloned().chain(of(3, false)).collect();
        for signs in [few, more] {
            let mut scene = scene.clone();
            scene.put("rival", drive("second", signs));
            let now = confidence(&scene.compare("query", "place"));
            prop_assert!(now <= last, "{now}, and {last} before");
            last = now;
        }
    }

    #[test]
    fn a_second_reading_in_one_passage_from_one_distance_changes_no_confidence(
        query in place(), candidate in place(), sure in 0.8..1.0_f64,
    ) {
        let mut scene = Scene::new();
        let passages = [("candidate", "first", things(&candidate)), ("query", "now", things(&query))];
        for (id, session, sights) in &passages {
            scene.put(id, drive(session, sights.clone()));
        }
        let answer = |scene: &Scene| {
            let found = scene.compare("query", "candidate");
            (found.decision, found.odds.map(|odds| odds.confidence))
        };
        let read_once = answer(&scene);
        for (id, session, sights) in passages {
            let sights = sights.into_iter().map(|thing| thing.confidence(sure));
            let again = drive(session, sights).words(&[(7, 1.0)]).covisible(&[id]);
            scene.put(&format!("{id}-again"), again);
            prop_assert_eq!(answer(&scene), read_once, "{}", id);
        }
    }

    #[test]
    fn nothing_that_a_copy_shares_lifts_a_candidate_to_a_loop(
        query in prop::collection::vec((0..SLOTS, 0..COPIED.len()), 0..30),
        more in prop::collection::vec((0..SLOTS, 0..COPIED.len()), 0..6),
        points in prop_oneof![Just(0_usize), 30..400_usize],
        level in prop_oneof![Just(2_u32), Just(4)],
    ) {
        let settings = Settings { description_min_information_level: level, ..Settings::default() };
        let sights: Vec<Thing> = query.iter().map(|(number, text)| copied(*number, *text)).collect();
        let of_copy = sights.iter().cloned().chain(more.iter().map(|(number, text)| copied(*number, *text)));
        let found = seen_twice(settings, points, sights.clone(), of_copy.collect());
        prop_assert_ne!(found.decision, CandidateDecision::Loop, "{:#?}", found);
        prop_assert!(confidence(&found) <= weights::NO_COPY.probability(), "{:#?}", found);
    }
}

#[test]
fn what_a_copy_shares_adds_up_as_long_as_the_map_says_that_nothing_repeats() {
    // The law above is not kept because such texts count for nothing.
    let sights: Vec<Thing> = (0..SLOTS).map(|number| copied(number, number)).collect();
    let with = |building_repeats| Settings { building_repeats, ..Settings::default() };
    let found = [true, false].map(|repeats| seen_twice(with(repeats), 400, sights.clone(), sights.clone()));
    assert_eq!(found[0].decision, CandidateDecision::Undecided);
    assert_eq!(code(&found[0]), Some(ReasonCode::TooLittleEvidence));
    assert_eq!(found[1].decision, CandidateDecision::Loop, "{:#?}", found[1]);
}
