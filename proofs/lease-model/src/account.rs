//! A counterexample in sentences, with names, epochs and versions that stay the same from step to step.

use std::fmt::Write as _;

use stateright::Model;

use crate::action::{Action, MapStep, NodeStep};
use crate::cluster::Cluster;
use crate::fold::{order, renumber};
use crate::state::{Memory, State};
use crate::steps;

const NAMES: [&str; 3] = ["A", "B", "C"];

/// Takes the steps that lead through these folded states, on states that are not folded, and returns a line for each.
pub fn narrate(cluster: &Cluster, folded: &[State]) -> String {
    let mut told = String::new();
    let mut state = State::new(cluster.limits, cluster.watched);
    for (number, wanted) in folded.iter().skip(1).enumerate() {
        let (action, next) = step_to(cluster, &state, wanted).expect("a step to each state of a path");
        let sentence = sentence(action, &state, &next);
        let _ = writeln!(told, "    {:>2}  {sentence:<78} {}", number + 1, changed_rows(&state, &next));
        state = next;
    }
    told
}

/// Finds the step to a state that folds to the wanted one.
fn step_to(cluster: &Cluster, state: &State, wanted: &State) -> Option<(Action, State)> {
    let mut actions = Vec::new();
    cluster.actions(state, &mut actions);
    actions.into_iter().find_map(|action| {
        let next = steps::next(cluster.rules, state, action)?;
        let mut folded = next;
        renumber(cluster.rules, &mut folded);
        if cluster.symmetric {
            order(&mut folded, cluster.nodes, cluster.maps);
        }
        (folded == *wanted).then_some((action, next))
    })
}

fn sentence(action: Action, before: &State, after: &State) -> String {
    match action {
        Action::Tick => "a tick passes".to_owned(),
        Action::OfNode(node, step) => {
            let name = NAMES[node];
            match step {
                NodeStep::Renew(maps) => {
                    let numbers = (0..maps.len()).filter(|&map| maps[map]).map(|map| (map + 1).to_string());
                    format!(
                        "{name} sends a renewal of map {}; it is executed",
                        numbers.collect::<Vec<_>>().join(", ")
                    )
                }
                NodeStep::ReceiveRenewal => format!("{name} receives the renewal's result"),
                NodeStep::Crash => format!("{name} stops, and starts with nothing in memory"),
            }
        }
        Action::OfMap(node, map, step) => {
            let told = of_map(step, before, after, node, map);
            format!("{} {told}", NAMES[node]).replace("MAP", &format!("map {}", map + 1))
        }
    }
}

fn of_map(step: MapStep, before: &State, after: &State, node: usize, map: usize) -> String {
    let holding = before.holding(node, map);
    let (version, known) = (holding.version, before.rows[map].known);
    let is_read = |state: &State| state.holding(node, map).read;
    let text = match step {
        MapStep::TakeOver => "takes MAP over",
        MapStep::LateTakeOver => "takes MAP over and never receives the result",
        MapStep::LateRenewal => "renews MAP by a request on which it has given up",
        MapStep::Load => return format!("loads MAP: version {}", after.holding(node, map).version),
        MapStep::Reload if after.holding(node, map).memory == Memory::Taken => "still owns MAP",
        MapStep::Reload => "owns MAP no longer, and drops it",
        MapStep::BeginWrite if after.holding(node, map).write.is_some() => {
            return format!("begins a write of MAP under epoch {}, on version {version}", holding.epoch);
        }
        MapStep::BeginWrite => "is fenced, and drops MAP",
        MapStep::Commit => return format!("commits the write of MAP: version {}", after.rows[map].version),
        MapStep::Acknowledge => return format!("acknowledges version {} of MAP", after.rows[map].known),
        MapStep::RollBack => "rolls the write of MAP back",
        MapStep::LoseConnection => "loses the connection of the write, and drops MAP",
        MapStep::CommitOrphan => "had a write of MAP left behind, which commits now",
        MapStep::RollBackOrphan => "had a write of MAP left behind, which is rolled back now",
        MapStep::Leave => "begins to hand MAP over",
        MapStep::SendRelease => "sends the release of MAP",
        MapStep::ExecuteRelease => "had sent a release of MAP, which is executed now",
        MapStep::ForgetReleased => "drops MAP, which it has released",
        MapStep::BeginRead if !is_read(after) => return format!("answers a read of MAP: version {version}"),
        // The check alone, where it comes before the request.
        MapStep::BeginRead if version >= known => "finds its lease of MAP valid, for a read to come",
        MapStep::BeginRead => return format!("reads MAP in memory: version {version}, clients know {known}"),
        MapStep::AnswerRead if version < known && holding.memory == Memory::Loaded => {
            return format!("answers a read of MAP: version {version}, clients know {known}");
        }
        MapStep::AnswerRead => "answers the read of MAP",
    };
    text.to_owned()
}

/// Returns the rows that a step has changed.
fn changed_rows(before: &State, after: &State) -> String {
    let mut told = String::new();
    for (map, (old, row)) in before.rows.iter().zip(&after.rows).enumerate() {
        if old != row {
            let owner = row.owner.map_or("none", |node| NAMES[usize::from(node)]);
            let _ = write!(
                told,
                "[map {}: owner {owner}, epoch {}, expires in {}, version {}, known {}] ",
                map + 1,
                row.epoch,
                row.expires,
                row.version,
                row.known
            );
        }
    }
    told.trim_end().to_owned()
}
