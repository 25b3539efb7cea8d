//! Time, and renewals against it.

use crate::rules::{LEASE, LeaseFrom, Rules};
use crate::state::{MAPS, Memory, Renewal, State};

/// Lets a tick pass on every clock: they run at the same rate.
pub(super) fn tick(state: &State) -> Option<State> {
    let mut next = *state;
    for row in &mut next.rows {
        row.expires = row.expires.saturating_sub(1);
    }
    for node in &mut next.nodes {
        for holding in &mut node.holdings {
            holding.valid = holding.valid.saturating_sub(1);
        }
        if let Some(renewal) = &mut node.renewal {
            renewal.valid = renewal.valid.saturating_sub(1);
        }
    }
    (next != *state).then_some(next)
}

/// Sends one statement for the maps in memory, and executes it. An earlier renewal without an answer is given up.
///
/// Any part of the maps can be named: a map that was taken over after the statement was sent is not in it.
pub(super) fn renew(rules: Rules, state: &State, node: usize, maps: [bool; MAPS]) -> Option<State> {
    let mut next = *state;
    let mut rows = [None; MAPS];
    for map in (0..MAPS).filter(|&map| maps[map]) {
        let holding = state.holding(node, map);
        if holding.memory == Memory::Absent {
            return None;
        }
        let renewed = state.is_owner(node, map, holding.epoch);
        if renewed {
            next.rows[map].expires = LEASE;
        }
        rows[map] = Some((holding.epoch, renewed));
    }
    next.nodes[node].renewal = Some(Renewal { valid: rules.valid_ticks(), rows });
    Some(next)
}

/// Applies the result of a renewal: rows that were returned are valid for longer, others are lost.
pub(super) fn receive(rules: Rules, state: &State, node: usize) -> Option<State> {
    let renewal = state.nodes[node].renewal?;
    let valid = if rules.lease_from == LeaseFrom::Returned { rules.valid_ticks() } else { renewal.valid };
    let mut next = *state;
    next.nodes[node].renewal = None;
    for (map, row) in renewal.rows.into_iter().enumerate() {
        let holding = next.holding_mut(node, map);
        match row {
            Some((epoch, renewed)) if holding.memory != Memory::Absent && holding.epoch == epoch => {
                if renewed {
                    holding.valid = holding.valid.max(valid);
                } else {
                    holding.drop_memory(rules.read_outlives_memory());
                }
            }
            _ => {}
        }
    }
    Some(next)
}

/// Executes a renewal whose sender no longer waits for it.
pub(super) fn late(state: &State, node: usize, map: usize) -> Option<State> {
    let row = &state.rows[map];
    if row.owner != Some(node as u8) || row.expires == LEASE {
        return None;
    }
    let mut next = *state;
    next.rows[map].expires = LEASE;
    Some(next)
}
