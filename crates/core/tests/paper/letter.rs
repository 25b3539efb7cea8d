//! The paper's method to the letter, written a second time: §V-A, Eq. (1) and Eq. (2), with nothing shared with the core.

use std::collections::BTreeSet;
use std::f64::consts::FRAC_PI_3;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use revisit_core::{CandidateDecision, Settings};

use super::scene::{Scene, anchors, candidate_of, door, keyframe, to_the_letter};

const KEYFRAMES: usize = 9;
const NUMBERS: [&str; 4] = ["901", "902", "903", "904"];

/// A keyframe that looks along z, with the doors it sees; none sees a door of another.
struct Shot {
    at: [f64; 3],
    covisible: BTreeSet<usize>,
    doors: Vec<(&'static str, [f64; 3])>,
}

/// A drive of random steps past random doors. Doors stand on a grid of 1.5 m, so that none is taken for another.
fn drive(seed: u64) -> Vec<Shot> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut free: Vec<[i32; 2]> = (-6..7).flat_map(|x| (1..5).map(move |z| [x, z])).collect();
    let mut shots: Vec<Shot> = Vec::new();
    for number in 0..KEYFRAMES {
        let at = [random.random_range(-2.0..2.0), 0.0, random.random_range(-1.0..0.5)];
        let doors = (0..random.random_range(0..4)).map(|_| {
            let [x, z] = free.swap_remove(random.random_range(0..free.len()));
            let number = NUMBERS[random.random_range(0..NUMBERS.len())];
            (number, [1.5 * f64::from(x), 0.2, 1.5 * f64::from(z)])
        });
        let doors = doors.collect();
        let earlier = (0..number).filter(|_| random.random_range(0..6) == 0).collect();
        shots.push(Shot { at, covisible: earlier, doors });
    }
    for number in 0..KEYFRAMES {
        for other in shots[number].covisible.clone() {
            shots[other].covisible.insert(number);
        }
    }
    shots
}

/// K_k^cov; it contains k.
fn covisible(shots: &[Shot], k: usize) -> BTreeSet<usize> {
    shots[k].covisible.iter().copied().chain([k]).collect()
}

/// M_k: each anchor of which a keyframe that observes it is covisible with one of K_k^cov, with theta_m and d_m.
fn local_map(shots: &[Shot], k: usize) -> Vec<(&'static str, [f64; 3], f64)> {
    let around = covisible(shots, k);
    let observers = (0..shots.len()).filter(|n| !covisible(shots, *n).is_disjoint(&around));
    let doors = observers.flat_map(|n| shots[n].doors.iter());
    let seen = doors.map(|(number, at)| {
        let from = shots[k].at;
        let to = [at[0] - from[0], at[1] - from[1], at[2] - from[2]];
        let distance = to.iter().map(|x| x * x).sum::<f64>().sqrt();
        (*number, to.map(|x| x / distance), distance)
    });
    seen.collect()
}

/// S of Eq. (2), every pair with x(i, j) = 1 summed.
fn similarity(shots: &[Shot], a: usize, b: usize) -> f64 {
    let (map_a, map_b) = (local_map(shots, a), local_map(shots, b));
    let weight = |distance: f64| 1.0 / distance.max(0.1);
    let mut matching = 0.0;
    for (number_a, theta_a, d_a) in &map_a {
        for (number_b, theta_b, d_b) in &map_b {
            let cosine: f64 = theta_a.iter().zip(theta_b).map(|(x, y)| x * y).sum();
            let is_near = cosine.clamp(-1.0, 1.0).acos() < FRAC_PI_3 && (d_a - d_b).abs() < 1.0;
            if number_a == number_b && is_near {
                matching += weight(*d_a) + weight(*d_b);
            }
        }
    }
    let all: f64 = map_a.iter().chain(&map_b).map(|(.., distance)| weight(*distance)).sum();
    if all > 0.0 { matching / all } else { 0.0 }
}

#[test]
fn the_papers_method_is_what_a_second_implementation_of_the_letter_says() {
    let (mut compared, mut loops) = (0, 0);
    for seed in 0..12 {
        let shots = drive(seed);
        let mut scene = Scene::with(Settings { candidates_max: 100, ..to_the_letter() });
        for (number, shot) in shots.iter().enumerate() {
            let earlier: Vec<String> =
                shot.covisible.iter().filter(|n| **n < number).map(|n| format!("kf-{n}")).collect();
            let earlier: Vec<&str> = earlier.iter().map(String::as_str).collect();
            let sights = shot.doors.iter().map(|(text, at)| door(text, *at));
            scene.put(&format!("kf-{number}"), keyframe().at(shot.at).covisible(&earlier).sees(sights));
        }
        for query in 0..KEYFRAMES {
            let verdict = scene.ask(&format!("kf-{query}"));
            for candidate in 0..KEYFRAMES {
                let Some(found) = candidate_of(&verdict, &format!("kf-{candidate}")) else { continue };
                assert!(!covisible(&shots, query).contains(&candidate), "check 1: {query}, {candidate}");
                let expected = similarity(&shots, query, candidate);
                let told = anchors(&found).similarity;
                assert!(
                    (told - expected).abs() < 1e-8,
                    "seed {seed}, {query}, {candidate}: {told}, {expected}"
                );
                let sides = [query, candidate].map(|k| local_map(&shots, k).len());
                let decision = match () {
                    () if expected > 0.3 => CandidateDecision::Loop,
                    () if sides.contains(&0) => CandidateDecision::Undecided,
                    () => CandidateDecision::Rejected,
                };
                assert_eq!(found.decision, decision, "seed {seed}, {query}, {candidate}: {found:#?}");
                compared += 1;
                loops += usize::from(decision == CandidateDecision::Loop);
            }
        }
    }
    // Worlds in which nothing agrees, or everything, would show nothing.
    assert!(compared > 300 && loops > 20 && loops < compared / 2, "{compared} compared, {loops} loops");
}
