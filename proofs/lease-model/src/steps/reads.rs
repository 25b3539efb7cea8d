//! Reads that a node answers from its memory.
//!
//! A read whose state is not behind what is known when it begins can never be wrong: what it returns becomes known to its client,
//! and nothing of it is kept. It is one step, at the moment when the state is read, which is the earliest that it can be answered.
//! Only a read whose state is behind stays, until its check refuses it or it is answered and is a fault. A read begins at the moment
//! its state is read where the check comes after: to begin earlier asks less of it.

use crate::rules::{ReadCheck, Rules};
use crate::state::{Fault, Memory, State};

/// Begins a read of a map in memory.
pub(super) fn begin(rules: Rules, state: &State, node: usize, map: usize) -> Option<State> {
    let holding = state.holding(node, map);
    if holding.memory != Memory::Loaded {
        return None;
    }
    let is_valid = holding.valid > 0;
    match rules.read_check {
        ReadCheck::AfterState | ReadCheck::AfterStateAnyLease if is_behind(state, node, map) => {
            wait(state, node, map)
        }
        ReadCheck::BeforeState if is_valid && is_behind(state, node, map) => wait(state, node, map),
        ReadCheck::AfterState | ReadCheck::AfterStateAnyLease | ReadCheck::BeforeState => {
            if is_valid {
                answer_at_once(state, node, map)
            } else {
                None
            }
        }
        // The check alone; the request is yet to come.
        ReadCheck::BeforeRequest => {
            if is_valid {
                wait(state, node, map)
            } else {
                None
            }
        }
        ReadCheck::Missing if is_behind(state, node, map) => wait(state, node, map),
        ReadCheck::Missing => answer_at_once(state, node, map),
    }
}

/// Answers a read that waits.
pub(super) fn answer(rules: Rules, state: &State, node: usize, map: usize) -> Option<State> {
    let holding = state.holding(node, map);
    if !holding.read {
        return None;
    }
    let is_valid = holding.valid > 0 && matches!(holding.memory, Memory::Taken | Memory::Loaded);
    match rules.read_check {
        ReadCheck::AfterState | ReadCheck::AfterStateAnyLease if !is_valid => None,
        ReadCheck::BeforeRequest if !is_behind(state, node, map) => {
            let mut next = answer_at_once(state, node, map).unwrap_or(*state);
            next.holding_mut(node, map).read = false;
            Some(next)
        }
        _ => Some(State { fault: Some(Fault::StaleRead), ..*state }),
    }
}

/// Whether the node's memory is older than what a client knows.
fn is_behind(state: &State, node: usize, map: usize) -> bool {
    state.holding(node, map).version < state.rows[map].known
}

/// Keeps a read until it is answered.
fn wait(state: &State, node: usize, map: usize) -> Option<State> {
    if state.holding(node, map).read {
        return None;
    }
    let mut next = *state;
    next.holding_mut(node, map).read = true;
    Some(next)
}

/// Returns the state in memory to a client, which then knows its version.
fn answer_at_once(state: &State, node: usize, map: usize) -> Option<State> {
    let version = state.holding(node, map).version;
    if version <= state.rows[map].known {
        return None;
    }
    let mut next = *state;
    next.rows[map].known = version;
    Some(next)
}
