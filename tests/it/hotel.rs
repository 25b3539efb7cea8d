//! The simulated hotel, driven through over HTTP: small tours, so that they can be driven at every change.

use std::collections::BTreeSet;

use revisit::api::verdict::CandidateView;
use revisit::client::Client;
use revisit::geometry::absolute_orientation::Scale;
use revisit::hotel::building::floor_plan::Layout;
use revisit::hotel::building::signs::SignPlan;
use revisit::hotel::building::texture::Patterns;
use revisit::hotel::building::world::{World, WorldPlan};
use revisit::hotel::method::Method;
use revisit::hotel::restart::asking::{ask, map_floors};
use revisit::hotel::restart::score::RestartScore;
use revisit::hotel::restart::world::{KEYFRAMES_OF_A_RESTART, RestartWorld};
use revisit::hotel::rng::SeededRng;
use revisit::hotel::route::tour;
use revisit::hotel::run::{Course, RunResult, WordsAlone, absolute_pose_error_m, drive, odometry};
use revisit::hotel::scoring::score::{Counts, Outcome, by_query, by_visit};
use revisit::hotel::sensing::noise::Noise;
use revisit::hotel::sequence::Sequence;

use crate::support::Server;

const DRIFT_M: f64 = 0.6;

fn course(repeated: bool, rooms: &[usize]) -> Course {
    let plan = WorldPlan {
        layout: Layout::SE1,
        floor: 9,
        signs: SignPlan { repeated, ..SignPlan::default() },
        seed: 7,
    };
    let world = World::new(&plan, &Patterns::new());
    let stops = tour(&world.plan, rooms, &mut SeededRng::new(7, "route"));
    Course::new(vec![Sequence::record(&world, &stops, Noise::default(), DRIFT_M, 7)])
}

async fn drive_through(course: &Course, arm: Method) -> RunResult {
    let directory = tempfile::tempdir().unwrap();
    let vocabulary = directory.path().join("hotel.voc");
    Patterns::new().vocabulary().unwrap().write_binary(std::fs::File::create(&vocabulary).unwrap()).unwrap();
    let server = Server::with_vocabulary(vocabulary).await;
    let client = Client::new(&server.url("")).unwrap();
    drive(&client, arm.as_str(), arm, course, |_| {}).await.unwrap()
}

fn counts(driven: &RunResult) -> (Counts, Counts) {
    let scored = driven.scored();
    (by_query(&scored), by_visit(&scored))
}

#[tokio::test]
async fn a_robot_among_twin_rooms_is_told_true_loops_only_and_ends_up_nearer_to_the_truth() {
    let course = course(false, &[3, 5, 3]);
    let ours = drive_through(&course, Method::Ours).await;
    let (by_query, by_visit) = counts(&ours);
    assert_eq!(by_query.precision(), 1.0, "{by_query:?}");
    assert!(by_query.recall() > 0.7, "{by_query:?}");
    assert_eq!((by_visit.precision(), by_visit.recall()), (1.0, 1.0), "{by_visit:?}");
    let drift_m = absolute_pose_error_m(&course.journeys, &odometry(&course), Scale::Fixed);
    assert!((drift_m - DRIFT_M).abs() < 1e-6, "odometry drifts as it was told to");
    assert!(ours.absolute_pose_error_m < drift_m, "{} m instead of {drift_m}", ours.absolute_pose_error_m);
}

#[tokio::test]
async fn words_alone_name_the_likest_keyframe_whether_it_is_this_room_or_its_twin() {
    let ours = drive_through(&course(false, &[3, 5, 3]), Method::Ours).await;
    let (mut right, mut wrong) = (0, 0);
    for asked in &ours.asked {
        let likest = asked.answer.candidates.iter().map(CandidateView::bow_score).fold(0.0, f64::max);
        match asked.words {
            WordsAlone::Names(named) => {
                assert_eq!(named.score, likest, "{:?}", asked.keyframe);
                *if named.is_right { &mut right } else { &mut wrong } += 1;
            }
            WordsAlone::Nothing => assert_eq!(likest, 0.0, "{:?}", asked.keyframe),
            WordsAlone::Unscored => {}
        }
    }
    assert!(right > 0 && wrong > right, "a twin room looks alike: {right} right, {wrong} wrong");
}

#[tokio::test]
async fn signs_that_hang_at_every_door_say_nothing_and_doors_in_a_row_are_told_apart() {
    let course = course(true, &[2, 6, 2]);
    let ours = drive_through(&course, Method::Ours).await;
    let (by_query, _) = counts(&ours);
    assert_eq!(by_query.precision(), 1.0, "{by_query:?}");
    let candidates = ours.asked.iter().flat_map(|asked| &asked.answer.candidates);
    let reasons: BTreeSet<&str> =
        candidates.filter_map(|candidate| Some(candidate.reason.as_ref()?.code.0.as_str())).collect();
    for code in ["too_little_evidence", "odometry_disagrees_with_transform", "contradiction"] {
        assert!(reasons.contains(code), "{code} is not among {reasons:?}");
    }
    let paper = drive_through(&course, Method::Paper).await;
    let told: Vec<bool> = (paper.asked.iter().zip(&course.answers))
        .filter_map(|(asked, answerable)| {
            let best = asked.answer.best.as_ref()?.strip_prefix("kf-")?.parse().unwrap();
            (!answerable.ignore.contains(&(0, best))).then(|| answerable.truth.contains(&(0, best)))
        })
        .collect();
    let right = told.iter().filter(|is_right| **is_right).count();
    assert!((right as f64) < 0.9 * told.len() as f64, "the world is too easy: {right} of {}", told.len());
    let closed = counts(&paper).0;
    assert!(closed.found > 0, "{closed:?}");
    assert!(closed.precision() > right as f64 / told.len() as f64, "what is confirmed is surer: {closed:?}");
}

#[tokio::test]
async fn a_robot_without_depth_is_told_loops_with_the_ratio_of_two_scales() {
    let course = course(false, &[3, 5, 3]);
    let driven = drive_through(&course, Method::OursMonocular).await;
    let counts = counts(&driven).0;
    assert!(counts.found > 10, "{counts:?}");
    let right = driven.asked.iter().filter(|asked| asked.scored.outcome == Outcome::Right);
    let scales: Vec<f64> =
        right.filter_map(|asked| Some(asked.answer.leading()?.geometry.full_transform()?.scale)).collect();
    assert!(!scales.is_empty(), "the images alone verify every loop, and they have no lengths");
    assert!(scales.iter().all(|scale| *scale != 1.0 && (0.7..1.4).contains(scale)), "{scales:?}");
    let error = driven.scale_error.expect("a monocular robot");
    assert_ne!(error.odometry, error.corrected, "loops move scales");
}

#[tokio::test]
async fn a_robot_that_wakes_up_on_one_of_three_floors_alike_is_told_no_wrong_floor() {
    const SEED: u64 = 3;
    let directory = tempfile::tempdir().unwrap();
    let vocabulary = directory.path().join("hotel.voc");
    Patterns::new().vocabulary().unwrap().write_binary(std::fs::File::create(&vocabulary).unwrap()).unwrap();
    let server = Server::with_vocabulary(vocabulary).await;
    let client = Client::new(&server.url("")).unwrap();
    let world = RestartWorld::new(SEED, KEYFRAMES_OF_A_RESTART, &Patterns::new());
    map_floors(&client, SEED, &world).await.unwrap();
    let mut score = RestartScore::default();
    for restart in &world.restarts {
        score.add(SEED, &world, restart, &ask(&client, SEED, restart).await.unwrap());
    }
    assert!(score.mapped.located > 0, "{score:?}");
    for counts in [score.mapped, score.unmapped] {
        assert_eq!(counts.right_floor, counts.located, "{score:?}");
    }
}
