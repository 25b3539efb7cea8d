//! Folded states behave as those that they stand for.

use std::collections::BTreeSet;

use revisit_lease_model::action::{Action, MapStep};
use revisit_lease_model::cases::{faulty, harmless, protocol};
use revisit_lease_model::cluster::Cluster;
use revisit_lease_model::fold::{order, renumber};
use revisit_lease_model::rules::{Limits, Rules};
use revisit_lease_model::state::State;
use revisit_lease_model::steps;
use stateright::Model as _;

const WALKS: u64 = 100;
const STEPS: usize = 120;

/// Numbers that are the same in every run (`SplitMix64`).
struct Draws(u64);

impl Draws {
    fn below(&mut self, end: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = self.0;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((mixed ^ (mixed >> 31)) % end as u64) as usize
    }
}

fn renumbered(cluster: &Cluster, mut state: State) -> State {
    renumber(cluster.rules, &mut state);
    state
}

fn folded(cluster: &Cluster, state: State) -> State {
    let mut state = renumbered(cluster, state);
    order(&mut state, cluster.nodes, cluster.maps);
    state
}

/// The state after a step, or the same state if the step cannot be taken.
fn after(rules: Rules, state: &State, action: Action) -> State {
    steps::next(rules, state, action).unwrap_or(*state)
}

fn actions(cluster: &Cluster, state: &State) -> Vec<Action> {
    let mut actions = Vec::new();
    cluster.actions(state, &mut actions);
    actions
}

/// Visits states of random walks that never fold, so that epochs and versions grow.
fn walk(cluster: &Cluster, seed: u64, mut visit: impl FnMut(&State, Action)) {
    let mut draws = Draws(seed);
    let mut state = State::new(Limits::NONE, false);
    for _ in 0..STEPS {
        let possible: Vec<(Action, State)> = actions(cluster, &state)
            .into_iter()
            .filter_map(|action| Some((action, steps::next(cluster.rules, &state, action)?)))
            .collect();
        if possible.is_empty() {
            return;
        }
        let (action, next) = possible[draws.below(possible.len())];
        visit(&state, action);
        state = next;
        // The order of versions is kept in 32 bits.
        if state.rows.iter().any(|row| row.version > 25) {
            return;
        }
    }
}

fn clusters() -> impl Iterator<Item = Cluster> {
    [protocol(&[]), harmless(), faulty()].concat().into_iter().map(|case| case.cluster)
}

#[test]
fn renumbering_changes_no_later_step() {
    for cluster in clusters() {
        for seed in 0..WALKS {
            walk(&cluster, seed, |state, _| {
                let stand_in = renumbered(&cluster, *state);
                for action in actions(&cluster, state) {
                    let plain = renumbered(&cluster, after(cluster.rules, state, action));
                    let other = renumbered(&cluster, after(cluster.rules, &stand_in, action));
                    assert_eq!(plain, other, "{action:?} after {state:#?}");
                }
            });
        }
    }
}

#[test]
fn names_of_nodes_and_maps_change_no_later_step() {
    let next = |cluster: &Cluster, state: &State| -> BTreeSet<State> {
        let actions = actions(cluster, state).into_iter();
        actions.map(|action| folded(cluster, after(cluster.rules, state, action))).collect()
    };
    for cluster in clusters() {
        for seed in 0..WALKS / 10 {
            walk(&cluster, seed, |state, _| {
                assert_eq!(next(&cluster, state), next(&cluster, &folded(&cluster, *state)));
            });
        }
    }
}

#[test]
fn every_step_of_the_protocol_is_taken() {
    let cluster = Cluster { nodes: 3, maps: 2, ..protocol(&[])[0].cluster };
    let mut missing = MapStep::ALL.to_vec();
    // The protocol has no such step; a read that waits is one that its check refuses.
    missing.retain(|step| !matches!(step, MapStep::ForgetReleased | MapStep::AnswerRead));
    for seed in 0..WALKS {
        walk(&cluster, seed, |_, action| {
            if let Action::OfMap(_, _, taken) = action {
                missing.retain(|step| *step != taken);
            }
        });
    }
    assert!(missing.is_empty(), "{missing:?}");
}
