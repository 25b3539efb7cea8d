//! The protocol: one function for each step, which returns the next state, or `None` if the step cannot be taken.
//!
//! A node that is paused, or cut from the database, takes no step for a while. Every order of steps is explored, so pauses need no
//! step of their own. A request is sent and executed in one step: a lease that is counted from then is the longest that a node can
//! believe in. A request that executes late, when its sender has given it up, has a step of its own.

mod ownership;
mod reads;
mod renewal;
mod stops;
mod writes;

use crate::action::{Action, MapStep, NodeStep};
use crate::rules::Rules;
use crate::state::State;

/// Returns the state after a step, or `None` if the step cannot be taken.
pub fn next(rules: Rules, state: &State, action: Action) -> Option<State> {
    match action {
        Action::Tick => renewal::tick(state),
        Action::OfNode(node, step) => match step {
            NodeStep::Renew(maps) => renewal::renew(rules, state, node, maps),
            NodeStep::ReceiveRenewal => renewal::receive(rules, state, node),
            NodeStep::Crash => stops::crash(state, node),
        },
        Action::OfMap(node, map, step) => match step {
            MapStep::TakeOver => ownership::take_over(rules, state, node, map),
            MapStep::LateTakeOver => ownership::late_take_over(rules, state, node, map),
            MapStep::LateRenewal => renewal::late(state, node, map),
            MapStep::Load => ownership::load(rules, state, node, map),
            MapStep::Reload => ownership::reload(rules, state, node, map),
            MapStep::BeginWrite => writes::begin(rules, state, node, map),
            MapStep::Commit => writes::commit(state, node, map),
            MapStep::Acknowledge => writes::acknowledge(state, node, map),
            MapStep::RollBack => writes::roll_back(state, node, map),
            MapStep::LoseConnection => stops::lose_connection(rules, state, node, map),
            MapStep::CommitOrphan => stops::commit_orphan(state, node, map),
            MapStep::RollBackOrphan => stops::roll_back_orphan(state, node, map),
            MapStep::Leave => ownership::leave(state, node, map),
            MapStep::SendRelease => ownership::send_release(rules, state, node, map),
            MapStep::ExecuteRelease => ownership::execute_release(state, node, map),
            MapStep::ForgetReleased => ownership::forget_released(rules, state, node, map),
            MapStep::BeginRead => reads::begin(rules, state, node, map),
            MapStep::AnswerRead => reads::answer(rules, state, node, map),
        },
    }
}
