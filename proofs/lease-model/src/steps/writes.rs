//! Write transactions from their first statement to the answer.

use crate::rules::{Rules, spend};
use crate::state::{Fault, Leaving, Memory, State, Write};

/// Decides a write on the version in memory, and executes the transaction's first statement:
/// `select ... where owner = me and epoch = mine for key share`.
pub(super) fn begin(rules: Rules, state: &State, node: usize, map: usize) -> Option<State> {
    let holding = state.holding(node, map);
    if holding.memory != Memory::Loaded || holding.leaving != Leaving::No || holding.write.is_some() {
        return None;
    }
    let mut next = *state;
    spend(&mut next.limits.writes)?;
    if rules.epoch_check && !state.is_owner(node, map, holding.epoch) {
        next.holding_mut(node, map).drop_memory(rules.read_outlives_memory());
    } else {
        let (epoch, version) = (holding.epoch, holding.version);
        next.holding_mut(node, map).write = Some(Write { committed: false, epoch, version });
    }
    Some(next)
}

/// Commits an open transaction, and records a fault if it must not have been accepted.
pub(super) fn accept(next: &mut State, map: usize, write: Write) -> Write {
    let row = &mut next.rows[map];
    if write.epoch != row.epoch {
        next.fault = Some(Fault::OldEpoch);
    } else if write.version != row.version {
        next.fault = Some(Fault::LostUpdate);
    }
    row.version = write.version + 1;
    Write { committed: true, version: row.version, ..write }
}

/// Commits the write under way.
pub(super) fn commit(state: &State, node: usize, map: usize) -> Option<State> {
    let write = state.holding(node, map).write.filter(|write| !write.committed)?;
    let mut next = *state;
    let write = accept(&mut next, map, write);
    next.holding_mut(node, map).write = Some(write);
    Some(next)
}

/// Brings the result of a commit to the node, which applies it and answers the client.
pub(super) fn acknowledge(state: &State, node: usize, map: usize) -> Option<State> {
    let write = state.holding(node, map).write.filter(|write| write.committed)?;
    let mut next = *state;
    let holding = next.holding_mut(node, map);
    holding.write = None;
    holding.version = write.version;
    let row = &mut next.rows[map];
    row.known = row.known.max(write.version);
    Some(next)
}

/// Rolls the write under way back; the client is answered with an error.
pub(super) fn roll_back(state: &State, node: usize, map: usize) -> Option<State> {
    state.holding(node, map).write.filter(|write| !write.committed)?;
    let mut next = *state;
    next.holding_mut(node, map).write = None;
    Some(next)
}
