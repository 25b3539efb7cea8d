//! Take-overs, loads and hand-overs.

use crate::rules::{LEASE, LeaseFrom, Rules, spend};
use crate::state::{Leaving, Memory, Parting, State};

/// Locks the row `for update`, and makes this node its owner under the next epoch. Waits for transactions that share the row.
fn take_row(rules: Rules, state: &State, node: usize, map: usize) -> Option<State> {
    let row = &state.rows[map];
    let is_free = row.owner.is_none() || row.expires == 0;
    if !is_free || (rules.take_over_waits && state.is_shared(map)) {
        return None;
    }
    let mut next = *state;
    spend(&mut next.limits.take_overs)?;
    let row = &mut next.rows[map];
    row.owner = Some(node as u8);
    row.former = None;
    row.epoch += 1;
    row.expires = LEASE;
    Some(next)
}

/// Takes a map over, and receives the result.
pub(super) fn take_over(rules: Rules, state: &State, node: usize, map: usize) -> Option<State> {
    if state.holding(node, map).memory != Memory::Absent {
        return None;
    }
    let mut next = take_row(rules, state, node, map)?;
    match state.rows[map].former {
        Some((former, Parting::Stopped)) => next.succession.after_death |= usize::from(former) != node,
        Some((former, Parting::Released)) => next.succession.after_release |= usize::from(former) != node,
        None => {}
    }
    let epoch = next.rows[map].epoch;
    let holding = next.holding_mut(node, map);
    holding.memory = Memory::Taken;
    holding.epoch = epoch;
    holding.valid = rules.valid_ticks();
    Some(next)
}

/// Executes a take-over on which the node has given up, because it stopped or its connection was lost.
pub(super) fn late_take_over(rules: Rules, state: &State, node: usize, map: usize) -> Option<State> {
    take_row(rules, state, node, map)
}

/// Reads the map's facts, without a lock, after the take-over has committed.
pub(super) fn load(rules: Rules, state: &State, node: usize, map: usize) -> Option<State> {
    if state.holding(node, map).memory != Memory::Taken {
        return None;
    }
    let mut next = *state;
    let version = next.rows[map].version;
    let holding = next.holding_mut(node, map);
    holding.memory = Memory::Loaded;
    holding.version = version;
    if rules.lease_from == LeaseFrom::Returned {
        holding.valid = rules.valid_ticks();
    }
    Some(next)
}

/// Asks for the row in the epoch that the node has, after a write in doubt. The lock waits for that write's end.
pub(super) fn reload(rules: Rules, state: &State, node: usize, map: usize) -> Option<State> {
    let holding = state.holding(node, map);
    if holding.memory != Memory::InDoubt || (rules.reload_waits && state.is_shared(map)) {
        return None;
    }
    let mut next = *state;
    if state.is_owner(node, map, holding.epoch) {
        next.holding_mut(node, map).memory = Memory::Taken;
    } else {
        next.holding_mut(node, map).drop_memory(rules.read_outlives_memory());
    }
    Some(next)
}

/// Begins a hand-over.
pub(super) fn leave(state: &State, node: usize, map: usize) -> Option<State> {
    let holding = state.holding(node, map);
    if holding.memory != Memory::Loaded || holding.leaving != Leaving::No {
        return None;
    }
    let mut next = *state;
    next.holding_mut(node, map).leaving = Leaving::Draining;
    Some(next)
}

/// Sends the release, once no write is under way.
pub(super) fn send_release(rules: Rules, state: &State, node: usize, map: usize) -> Option<State> {
    let holding = state.holding(node, map);
    if holding.leaving != Leaving::Draining || holding.write.is_some() {
        return None;
    }
    let mut next = *state;
    let holding = next.holding_mut(node, map);
    let epoch = holding.epoch;
    if rules.drop_before_release {
        holding.drop_memory(rules.read_outlives_memory());
    } else {
        holding.leaving = Leaving::Released;
    }
    holding.release = Some(epoch);
    Some(next)
}

/// Executes `update ... set owner = null where owner = me and epoch = mine`, at any time after it was sent.
pub(super) fn execute_release(state: &State, node: usize, map: usize) -> Option<State> {
    let epoch = state.holding(node, map).release?;
    let mut next = *state;
    next.holding_mut(node, map).release = None;
    if state.is_owner(node, map, epoch) {
        let row = &mut next.rows[map];
        row.owner = None;
        row.expires = 0;
        row.former = state.watched.then_some((node as u8, Parting::Released));
    }
    Some(next)
}

/// Drops the map only when its release has returned.
pub(super) fn forget_released(rules: Rules, state: &State, node: usize, map: usize) -> Option<State> {
    let holding = state.holding(node, map);
    if holding.leaving != Leaving::Released || holding.release.is_some() {
        return None;
    }
    let mut next = *state;
    next.holding_mut(node, map).drop_memory(rules.read_outlives_memory());
    Some(next)
}
