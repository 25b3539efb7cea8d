//! The model that the checker runs: a number of nodes and maps under some rules.

use stateright::{Model, Property};

use crate::action::{Action, MapStep, NodeStep};
use crate::fold::{order, renumber};
use crate::rules::{Limits, Rules};
use crate::state::{Fault, State};
use crate::steps;

/// Servers over one database.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cluster {
    /// The protocol, or a variant of it.
    pub rules: Rules,
    /// Number of servers.
    pub nodes: usize,
    /// Number of maps.
    pub maps: usize,
    /// Limits of the run.
    pub limits: Limits,
    /// Whether states that differ only in the names of nodes and maps are one. `account` gives a path its names back.
    pub symmetric: bool,
    /// Whether take-overs are watched for, which makes more states.
    pub watched: bool,
}

impl Model for Cluster {
    type State = State;
    type Action = Action;

    fn init_states(&self) -> Vec<State> {
        vec![State::new(self.limits, self.watched)]
    }

    fn actions(&self, state: &State, actions: &mut Vec<Action>) {
        if state.fault.is_some() {
            return;
        }
        actions.push(Action::Tick);
        for node in 0..self.nodes {
            actions.push(Action::OfNode(node, NodeStep::Crash));
            actions.push(Action::OfNode(node, NodeStep::ReceiveRenewal));
            for maps in [[true, false], [false, true], [true, true]] {
                if self.maps > 1 || !maps[1] {
                    actions.push(Action::OfNode(node, NodeStep::Renew(maps)));
                }
            }
            for map in 0..self.maps {
                actions.extend(MapStep::ALL.map(|step| Action::OfMap(node, map, step)));
            }
        }
    }

    fn next_state(&self, state: &State, action: Action) -> Option<State> {
        let mut next = steps::next(self.rules, state, action)?;
        renumber(self.rules, &mut next);
        if self.symmetric {
            order(&mut next, self.nodes, self.maps);
        }
        (next != *state).then_some(next)
    }

    fn properties(&self) -> Vec<Property<Self>> {
        let mut properties = vec![
            Property::always(NO_LOST_UPDATE, |_, state: &State| state.fault != Some(Fault::LostUpdate)),
            Property::always(NEWEST_EPOCH, |_, state: &State| state.fault != Some(Fault::OldEpoch)),
            Property::always(NO_STALE_READ, |_, state: &State| state.fault != Some(Fault::StaleRead)),
        ];
        if self.watched {
            properties
                .push(Property::sometimes(AFTER_DEATH, |_, state: &State| state.succession.after_death));
            properties
                .push(Property::sometimes(AFTER_RELEASE, |_, state: &State| state.succession.after_release));
        }
        properties
    }
}

/// Name of a property.
pub const NO_LOST_UPDATE: &str = "versions are dense, each of one write";
/// Name of a property.
pub const NEWEST_EPOCH: &str = "writes are accepted under the newest epoch alone";
/// Name of a property.
pub const NO_STALE_READ: &str = "a read returns at least what was known before it";
/// Name of a property.
pub const AFTER_DEATH: &str = "a map whose owner stopped is taken over by another node";
/// Name of a property.
pub const AFTER_RELEASE: &str = "a map is handed over to another node";
