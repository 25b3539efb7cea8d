//! Nodes that stop, lost connections, and the transactions that both leave behind.

use super::writes::accept;
use crate::rules::{Rules, spend};
use crate::state::{Leaving, Memory, Parting, State};

/// Stops a node, which starts again with nothing in memory. Its open transactions and its releases are left to the database.
pub(super) fn crash(state: &State, node: usize) -> Option<State> {
    let had = &state.nodes[node];
    if had.renewal.is_none() && had.holdings.iter().all(|holding| holding.memory == Memory::Absent) {
        return None;
    }
    let mut next = *state;
    spend(&mut next.limits.failures)?;
    next.nodes[node].renewal = None;
    for (holding, row) in next.nodes[node].holdings.iter_mut().zip(&mut next.rows) {
        // A read that was under way is never answered, whatever the rules.
        holding.drop_memory(false);
        if state.watched && row.owner == Some(node as u8) {
            row.former = Some((node as u8, Parting::Stopped));
        }
    }
    Some(next)
}

/// Loses the connection of a write: its fate is unknown, the client is not answered, and the map leaves the memory.
pub(super) fn lose_connection(rules: Rules, state: &State, node: usize, map: usize) -> Option<State> {
    state.holding(node, map).write?;
    let mut next = *state;
    spend(&mut next.limits.failures)?;
    let holding = next.holding_mut(node, map);
    holding.abandon_write();
    holding.memory = Memory::InDoubt;
    holding.version = 0;
    holding.leaving = Leaving::No;
    holding.read &= rules.read_outlives_memory();
    Some(next)
}

/// Commits a transaction that was left behind.
pub(super) fn commit_orphan(state: &State, node: usize, map: usize) -> Option<State> {
    let orphan = state.holding(node, map).orphan?;
    let mut next = *state;
    next.holding_mut(node, map).orphan = None;
    accept(&mut next, map, orphan);
    Some(next)
}

/// Rolls back a transaction that was left behind.
pub(super) fn roll_back_orphan(state: &State, node: usize, map: usize) -> Option<State> {
    state.holding(node, map).orphan?;
    let mut next = *state;
    next.holding_mut(node, map).orphan = None;
    Some(next)
}
