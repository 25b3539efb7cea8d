//! Robots that start somewhere in a plan's building, and how soon their sessions are aligned to the plan.
//!
//! `cargo run --release --example plan_starts -- SIGNS.tsv [STARTS] [SEED]`, with lines of frame, text, x, y and z in metres.
//! A robot drives past signs, sees those within 6 m, and reads 15 % of them wrongly: half of these with one character changed,
//! half as another sign of the plan. A sighting's position is off by 0.3 m and 3 % of its distance along each axis.

// A simulation may compute with the platform's own sines.
#![allow(clippy::disallowed_methods)]

use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};
use std::process::ExitCode;

use rand::seq::IndexedRandom as _;
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use revisit_core::domain::change::Change;
use revisit_core::domain::keyframe::{Detection, NewKeyframe, Stamp};
use revisit_core::domain::map::MapProperties;
use revisit_core::domain::prior::NewPrior;
use revisit_core::geometry::{Point3, Pose};
use revisit_core::recognition::anchors::ingest::ingest;
use revisit_core::recognition::anchors::prior_anchors::add_prior;
use revisit_core::recognition::map::index::MapIndex;
use revisit_core::recognition::plans::alignments::Alignments;
use revisit_core::recognition::plans::planar_fit::{FitPair, PlanarFit};

const SEEN_M: f64 = 6.0;
const MISREAD_SHARE: f64 = 0.15;
const STEP_M: f64 = 1.0;
const KEYFRAMES: usize = 60;
const CLASS: &str = "door_number";

struct Sign {
    frame: String,
    text: String,
    at: Point3,
}

fn normal(rng: &mut ChaCha8Rng) -> f64 {
    let (a, b): (f64, f64) = (rng.random_range(f64::EPSILON..1.0), rng.random_range(0.0..TAU));
    (-2.0 * a.ln()).sqrt() * b.cos()
}

fn read(path: &str) -> Vec<Sign> {
    let file = std::fs::read_to_string(path).expect("a readable file");
    let sign = |line: &str| {
        let fields: Vec<&str> = line.split('\t').collect();
        let at = |field: usize| fields[field].parse::<f64>().expect("a number");
        Sign { frame: fields[0].to_owned(), text: fields[1].to_owned(), at: Point3::new(at(2), at(3), at(4)) }
    };
    file.lines().filter(|line| !line.trim().is_empty()).map(sign).collect()
}

fn plan(signs: &[Sign]) -> MapIndex {
    let mut index = MapIndex::default();
    index.apply(&[Change::MapSet(Box::new(MapProperties { metric: true, ..MapProperties::default() }))]);
    for (number, sign) in signs.iter().enumerate() {
        let prior = NewPrior {
            id: format!("sign-{number}").parse().expect("an id"),
            class: CLASS.to_owned(),
            description: sign.text.clone(),
            position_in_frame: sign.at,
            frame: sign.frame.parse().expect("an id"),
            normal_in_frame: None,
            source: None,
        };
        add_prior(&mut index, &prior);
    }
    index
}

/// Returns the way of a robot past signs of one frame: each time to one of the three nearest that are left.
fn way(signs: &[Sign], rng: &mut ChaCha8Rng) -> (String, Vec<Point3>) {
    let first = signs.choose(rng).expect("a sign");
    let mut left: Vec<&Sign> = signs.iter().filter(|sign| sign.frame == first.frame).collect();
    let beside = |sign: &Sign, rng: &mut ChaCha8Rng| {
        let angle = rng.random_range(0.0..TAU);
        sign.at + nalgebra::Vector3::new(1.5 * angle.cos(), 1.5 * angle.sin(), 0.0)
    };
    let mut place = beside(first, rng);
    let mut way = vec![place];
    while way.len() < KEYFRAMES && !left.is_empty() {
        left.sort_by(|a, b| (a.at - place).norm().total_cmp(&(b.at - place).norm()));
        let next = left.remove(rng.random_range(0..left.len().min(3)));
        let target = beside(next, rng);
        while (target - place).norm() > STEP_M && way.len() < KEYFRAMES {
            place += (target - place).normalize() * STEP_M;
            way.push(place);
        }
    }
    (first.frame.clone(), way)
}

fn misread(text: &str, signs: &[Sign], rng: &mut ChaCha8Rng) -> String {
    if rng.random_bool(0.5) {
        return signs.choose(rng).expect("a sign").text.clone();
    }
    let mut letters: Vec<char> = text.chars().collect();
    let at = rng.random_range(0..letters.len());
    letters[at] = char::from(if letters[at].is_ascii_digit() {
        b'0' + rng.random_range(0..10u8)
    } else {
        b'a' + rng.random_range(0..26u8)
    });
    letters.into_iter().collect()
}

/// What is known after a keyframe: whether the session is aligned, and how far off.
#[derive(Clone, Copy)]
struct State {
    right_distinctive: usize,
    /// The distance between the first two signs that were read rightly, in metres.
    apart_m: f64,
    /// Position in metres and rotation in degrees; infinite on another floor.
    error: Option<(f64, f64)>,
    /// The same of a fit to the signs read rightly whose places in the plan are given: what the sightings allow.
    known: Option<(f64, f64)>,
}

fn drive(signs: &[Sign], plan: &MapIndex, covisible: bool, rng: &mut ChaCha8Rng) -> Vec<State> {
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    for sign in signs {
        *counts.entry(&sign.text).or_default() += 1;
    }
    let (frame, way) = way(signs, rng);
    let (yaw, shift) = (rng.random_range(-PI..PI), [normal(rng) * 20.0, normal(rng) * 20.0, normal(rng)]);
    let session_from_plan =
        Pose::new(shift, [0.0, 0.0, (yaw / 2.0).sin(), (yaw / 2.0).cos()]).expect("a pose");
    // Optical axes of a level camera: z along the plan's x.
    let level = Pose::new([0.0; 3], [-0.5, 0.5, -0.5, 0.5]).expect("a pose");
    let mut index = plan.clone();
    let mut right: BTreeMap<String, Point3> = BTreeMap::new();
    let mut apart_m = 0.0;
    let mut sighted: BTreeMap<String, Sighted> = BTreeMap::new();
    let mut states = Vec::new();
    for (number, place) in way.iter().enumerate() {
        let camera_in_plan = Pose::new([place.x, place.y, place.z], [0.0, 0.0, 0.0, 1.0]).expect("a pose");
        let pose = session_from_plan.after(&camera_in_plan).after(&level);
        let id = format!("kf-{number}").parse().expect("an id");
        let mut keyframe = NewKeyframe::at(id, Stamp { sec: number as i64, nanosec: 0 }, pose);
        if covisible && number > 0 {
            keyframe.covisible = Some(vec![(format!("kf-{}", number - 1).parse().expect("an id"), 50)]);
        }
        for sign in signs.iter().filter(|sign| sign.frame == frame) {
            let distance = (sign.at - place).norm();
            if distance > SEEN_M {
                continue;
            }
            let sigma = 0.3 + 0.03 * distance;
            let noise = nalgebra::Vector3::from_fn(|_, _| normal(rng) * sigma);
            let is_misread = rng.random_bool(MISREAD_SHARE);
            let text = if is_misread { misread(&sign.text, signs, rng) } else { sign.text.clone() };
            if text == sign.text && counts[&*sign.text] == 1 {
                if right.len() == 1 && !right.contains_key(&text) {
                    apart_m = right.values().map(|first| (first - sign.at).norm()).sum();
                }
                right.insert(text.clone(), sign.at);
            }
            let at = session_from_plan.transform(&(sign.at + noise));
            let of_sign = sighted.entry(sign.text.clone()).or_default();
            of_sign.weight += 1.0 / (sigma * sigma);
            of_sign.sum += at.coords / (sigma * sigma);
            let detection = Detection {
                position_in_session: Some(at),
                text: Some(text),
                ..Detection::of(CLASS, 0.9, [0.0, 0.0, 10.0, 10.0])
            };
            keyframe.detections.push(detection);
        }
        ingest(&mut index, &keyframe);
        let session = index.session(&keyframe.session).expect("a session");
        let error = Alignments::of(&index).session(session).map(|alignment| {
            if index.sessions()[alignment.frame.index()].as_str() != frame {
                return (f64::INFINITY, 180.0);
            }
            off_by(&alignment.plan_from_session, &session_from_plan, place)
        });
        let pairs = right.iter().filter_map(|(text, at)| Some((sighted.get(text)?, at)));
        let pairs: Vec<FitPair> = pairs
            .map(|(seen, at)| FitPair {
                inner: seen.sum / seen.weight,
                outer: at.coords,
                variance: 1.0 / seen.weight,
            })
            .collect();
        let known = PlanarFit::of(&pairs)
            .map(|fit| off_by(&Pose::from(nalgebra::Isometry3::from(fit.pose)), &session_from_plan, place));
        states.push(State { right_distinctive: right.len(), apart_m, error, known });
    }
    states
}

/// The sightings of a sign, weighted.
#[derive(Default)]
struct Sighted {
    weight: f64,
    sum: nalgebra::Vector3<f64>,
}

/// Returns how far a place is moved along the floor, in metres, and the rotation, in degrees.
fn off_by(plan_from_session: &Pose, session_from_plan: &Pose, place: &Point3) -> (f64, f64) {
    let off = plan_from_session.after(session_from_plan);
    let moved = off.transform(place) - place;
    let [.., z, w] = off.rotation_xyzw();
    let angle = 2.0 * z.atan2(w).to_degrees();
    (moved.xy().norm(), angle.abs().min(360.0 - angle.abs()))
}

fn is_good((m, deg): &(f64, f64)) -> bool {
    *m <= 1.0 && *deg <= 5.0
}

fn percent(part: usize, of: usize) -> f64 {
    100.0 * part as f64 / of.max(1) as f64
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let Some(path) = arguments.first() else { return ExitCode::FAILURE };
    let number =
        |at: usize, default: u64| arguments.get(at).and_then(|text| text.parse().ok()).unwrap_or(default);
    let (starts, seed) = (number(1, 200), number(2, 1));
    let signs = read(path);
    let plan = plan(&signs);
    let mut is_right = true;
    for covisible in [true, false] {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let drives: Vec<Vec<State>> =
            (0..starts).map(|_| drive(&signs, &plan, covisible, &mut rng)).collect();
        println!(
            "{} signs, {starts} starts, keyframes {}",
            signs.len(),
            if covisible { "joined" } else { "alone" }
        );
        println!(
            "after        starts  aligned  within 1 m and 5 deg  of these aligned  pairs given  > 3 m  other floor"
        );
        for (what, wanted) in [("2nd right", 2), ("3rd right", 3), ("4th right", 4), ("6th right", 6)] {
            for later in [0, 3] {
                let after: Vec<State> = drives
                    .iter()
                    .filter_map(|states| {
                        let at = states.iter().position(|state| state.right_distinctive >= wanted)?;
                        states.get(at + later).copied()
                    })
                    .collect();
                let errors: Vec<(f64, f64)> = after.iter().filter_map(|state| state.error).collect();
                let good = errors.iter().filter(|error| is_good(error)).count();
                let known = after.iter().filter_map(|state| state.known).filter(is_good).count();
                let far = errors.iter().filter(|(m, _)| *m > 3.0).count();
                let other = errors.iter().filter(|(m, _)| m.is_infinite()).count();
                println!(
                    "{what} + {later}  {:6}  {:6.1}%  {:19.1}%  {:15.1}%  {:10.1}%  {far:5}  {other:11}",
                    after.len(),
                    percent(errors.len(), after.len()),
                    percent(good, after.len()),
                    percent(good, errors.len()),
                    percent(known, after.len()),
                );
            }
        }
        println!("the 2nd right sign + 3, by its distance from the first:");
        for (from, to) in [(0.0, 2.0), (2.0, 4.0), (4.0, 6.0), (6.0, f64::INFINITY)] {
            let after: Vec<State> = drives
                .iter()
                .filter_map(|states| {
                    let at = states.iter().position(|state| state.right_distinctive >= 2)?;
                    states.get(at + 3).copied()
                })
                .filter(|state| (from..to).contains(&state.apart_m))
                .collect();
            let aligned = after.iter().filter(|state| state.error.is_some()).count();
            let good = after.iter().filter_map(|state| state.error).filter(is_good).count();
            let known = after.iter().filter_map(|state| state.known).filter(is_good).count();
            println!(
                "{from:4} m to {to:4} m  {:6}  {:6.1}%  {:19.1}%  {:27.1}%",
                after.len(),
                percent(aligned, after.len()),
                percent(good, after.len()),
                percent(known, after.len()),
            );
        }
        let ever = |is: fn(f64) -> bool| {
            let wrong =
                |states: &&Vec<State>| states.iter().any(|state| state.error.is_some_and(|(m, _)| is(m)));
            drives.iter().filter(wrong).count()
        };
        let on_another_floor = ever(f64::is_infinite);
        println!(
            "ever > 3 m: {} of {starts}; ever on another floor: {on_another_floor}\n",
            ever(|m| m > 3.0)
        );
        is_right &= on_another_floor == 0;
    }
    if is_right { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
