//! The runs of `proofs/lease`, and the outcome that each must have.

use std::collections::BTreeSet;
use std::time::Instant;

use stateright::{Checker as _, HasDiscoveries, Model as _};

use crate::account::narrate;
use crate::cluster::{AFTER_DEATH, AFTER_RELEASE, Cluster, NEWEST_EPOCH, NO_LOST_UPDATE, NO_STALE_READ};
use crate::rules::{LeaseFrom, Limits, ReadCheck, Rules};

/// One run of the checker.
#[derive(Clone, Copy, Debug)]
pub struct Case {
    /// The protocol, or the part of it that is left out.
    pub name: &'static str,
    /// The model.
    pub cluster: Cluster,
    /// Its outcome.
    pub expected: Expected,
}

/// The outcome that a run must have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Expected {
    /// No property is violated, in any state.
    Holds,
    /// Both kinds of succession occur.
    Occurs,
    /// This property is the first that is violated.
    Violates(&'static str),
}

/// The outcome that a run had.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Number of states that differ.
    pub states: usize,
    /// Number of steps taken from them.
    pub steps: usize,
    /// Time it took.
    pub seconds: f64,
    /// Properties that were violated, or that occurred, and the path to each.
    pub found: Vec<(&'static str, String)>,
    /// Whether it is the expected one.
    pub is_expected: bool,
}

/// Limits under which faults must be found, and under which the short form checks two maps.
pub const SHORT: Limits = Limits { take_overs: 3, writes: 2, failures: 1 };
/// Limits under which the long form checks two maps.
pub const LONG: [Limits; 2] =
    [Limits { take_overs: 3, writes: 3, failures: 2 }, Limits { take_overs: 4, writes: 2, failures: 1 }];

/// Returns the runs of the protocol as it is meant: one map without limits, two maps with each of these.
pub fn protocol(two_maps: &[Limits]) -> Vec<Case> {
    let case = |name, nodes, maps, limits, watched, expected| {
        let cluster = Cluster { rules: Rules::PROTOCOL, nodes, maps, limits, symmetric: true, watched };
        Case { name, cluster, expected }
    };
    let one_map = case("the protocol", 3, 1, Limits::NONE, false, Expected::Holds);
    let watched = case("the protocol, watched for take-overs", 3, 2, SHORT, true, Expected::Occurs);
    let limited = two_maps.iter().map(|&limits| case("the protocol", 3, 2, limits, false, Expected::Holds));
    [one_map, watched].into_iter().chain(limited).collect()
}

/// Returns variants that lack a part: each must be found.
pub fn faulty() -> Vec<Case> {
    let case = |name, rules, property| {
        let cluster = Cluster { rules, nodes: 3, maps: 2, limits: SHORT, symmetric: true, watched: false };
        Case { name, cluster, expected: Expected::Violates(property) }
    };
    let meant = Rules::PROTOCOL;
    vec![
        case("no epoch check in a write", Rules { epoch_check: false, ..meant }, NEWEST_EPOCH),
        case("a take-over that ignores open writes", Rules { take_over_waits: false, ..meant }, NEWEST_EPOCH),
        case(
            "a load after a write in doubt that ignores this write",
            Rules { reload_waits: false, ..meant },
            NO_LOST_UPDATE,
        ),
        case(
            "a lease that is counted from its answer",
            Rules { lease_from: LeaseFrom::Returned, ..meant },
            NO_STALE_READ,
        ),
        case(
            "a map that is dropped after its release",
            Rules { drop_before_release: false, ..meant },
            NO_STALE_READ,
        ),
        case("reads without a check", Rules { read_check: ReadCheck::Missing, ..meant }, NO_STALE_READ),
        case(
            "reads whose check is older than the request",
            Rules { read_check: ReadCheck::BeforeRequest, ..meant },
            NO_STALE_READ,
        ),
        case(
            "reads that check another lease than that of their state",
            Rules { read_check: ReadCheck::AfterStateAnyLease, ..meant },
            NO_STALE_READ,
        ),
    ]
}

/// Returns variants that hold as well, in the model.
pub fn harmless() -> Vec<Case> {
    let case = |name, rules| {
        let cluster =
            Cluster { rules, nodes: 2, maps: 1, limits: Limits::NONE, symmetric: true, watched: false };
        Case { name, cluster, expected: Expected::Holds }
    };
    let meant = Rules::PROTOCOL;
    vec![
        case(
            "reads that check after they began, before their state",
            Rules { read_check: ReadCheck::BeforeState, ..meant },
        ),
        case("no margin, as all clocks run alike", Rules { margin: 0, ..meant }),
    ]
}

impl Case {
    /// Runs the checker.
    pub fn run(&self) -> Outcome {
        let began = Instant::now();
        let (threads, finish) = match self.expected {
            // With one thread the path to a fault is the shortest, and always the same.
            Expected::Violates(_) => (1, HasDiscoveries::AnyFailures),
            Expected::Occurs => (1, HasDiscoveries::AllOf(BTreeSet::from([AFTER_DEATH, AFTER_RELEASE]))),
            Expected::Holds => {
                (std::thread::available_parallelism().map_or(1, usize::from), HasDiscoveries::AnyFailures)
            }
        };
        let checker = self.cluster.checker().threads(threads).finish_when(finish).spawn_bfs().join();
        let mut found: Vec<_> = checker
            .discoveries()
            .into_iter()
            .map(|(property, path)| (property, narrate(&self.cluster, &path.into_states())))
            .collect();
        found.sort();
        let names: Vec<&str> = found.iter().map(|(property, _)| *property).collect();
        let is_expected = match self.expected {
            Expected::Holds => names.is_empty(),
            Expected::Occurs => names == [AFTER_RELEASE, AFTER_DEATH],
            Expected::Violates(property) => names == [property],
        };
        Outcome {
            states: checker.unique_state_count(),
            steps: checker.state_count(),
            seconds: began.elapsed().as_secs_f64(),
            found,
            is_expected,
        }
    }
}
