//! States that behave alike become one.
//!
//! An epoch is only ever compared with the row's for equality, and a version with what is known (whether it is behind) and with the
//! row's (whether it is the same). So each can be numbered afresh after every step without a change in any later step, and runs
//! need no limit of epochs, versions and, as leases are counted in ticks that are left, of time.

use crate::rules::{LeaseFrom, Rules};
use crate::state::{Holding, Leaving, MAPS, Memory, NODES, Row, State};

/// Numbers epochs and versions of every map afresh, and removes requests that can no longer have an effect.
pub fn renumber(rules: Rules, state: &mut State) {
    for map in 0..MAPS {
        let epoch = state.rows[map].epoch;
        let ranks = Ranks::of(state, map);
        for node in &mut state.nodes {
            let holding = &mut node.holdings[map];
            if let Some(renewal) = &mut node.renewal {
                let extends = rules.lease_from == LeaseFrom::Returned || renewal.valid > holding.valid;
                renewal.rows[map] = renewal.rows[map]
                    .filter(|row| holding.memory != Memory::Absent && row.0 == holding.epoch)
                    .filter(|row| !row.1 || extends)
                    .map(|(named, renewed)| (u8::from(named == epoch), renewed));
            }
            renumber_holding(holding, epoch, &ranks);
        }
        renumber_row(&mut state.rows[map], &ranks);
    }
    for node in &mut state.nodes {
        node.renewal = node.renewal.filter(|renewal| renewal.rows != [None; MAPS]);
    }
}

fn renumber_holding(holding: &mut Holding, epoch: u8, ranks: &Ranks) {
    holding.epoch = u8::from(holding.memory != Memory::Absent && holding.epoch == epoch);
    // A release under an older epoch finds no row; it counts only where a node waits for its return.
    holding.release = holding
        .release
        .filter(|&released| released == epoch || holding.leaving == Leaving::Released)
        .map(|released| u8::from(released == epoch));
    if holding.memory == Memory::Loaded {
        holding.version = ranks.rank(holding.version);
    }
    for write in [&mut holding.write, &mut holding.orphan].into_iter().flatten() {
        write.epoch = u8::from(write.epoch == epoch);
        write.version = ranks.rank(write.version);
    }
}

fn renumber_row(row: &mut Row, ranks: &Ranks) {
    row.epoch = row.epoch.min(1);
    row.version = ranks.rank(row.version);
    row.known = ranks.rank(row.known);
}

/// The order of a map's versions: 0 is behind what is known, 1 is known, and each newer one in use follows.
struct Ranks {
    known: u8,
    /// A bit for each version in use from `known` on.
    used: u32,
}

impl Ranks {
    fn of(state: &State, map: usize) -> Self {
        let row = &state.rows[map];
        let mut ranks = Self { known: row.known, used: 1 };
        ranks.add(row.version);
        for node in &state.nodes {
            let holding = &node.holdings[map];
            if holding.memory == Memory::Loaded {
                ranks.add(holding.version);
            }
            for write in [holding.write, holding.orphan].into_iter().flatten() {
                ranks.add(write.version);
            }
        }
        ranks
    }

    fn add(&mut self, version: u8) {
        if let Some(above) = version.checked_sub(self.known) {
            self.used |= 1 << above;
        }
    }

    fn rank(&self, version: u8) -> u8 {
        match version.checked_sub(self.known) {
            Some(above) => (self.used & ((1 << above) - 1)).count_ones() as u8 + 1,
            None => 0,
        }
    }
}

/// Puts nodes and maps into one order: which of them is called what makes no difference.
pub fn order(state: &mut State, nodes: usize, maps: usize) {
    order_nodes(state, nodes);
    if maps == MAPS {
        let mut swapped = *state;
        swapped.rows.swap(0, 1);
        for node in &mut swapped.nodes {
            node.holdings.swap(0, 1);
            if let Some(renewal) = &mut node.renewal {
                renewal.rows.swap(0, 1);
            }
        }
        order_nodes(&mut swapped, nodes);
        if swapped < *state {
            *state = swapped;
        }
    }
}

fn order_nodes(state: &mut State, nodes: usize) {
    let mut places: [u8; NODES] = std::array::from_fn(|node| node as u8);
    let owns = |node: u8| {
        state.rows.map(|row| (row.owner == Some(node), row.former.is_some_and(|(former, _)| former == node)))
    };
    places[..nodes].sort_by(|&a, &b| {
        owns(a).cmp(&owns(b)).then_with(|| state.nodes[usize::from(a)].cmp(&state.nodes[usize::from(b)]))
    });
    if places.is_sorted() {
        return;
    }
    let before = *state;
    for (place, &node) in places.iter().enumerate() {
        state.nodes[place] = before.nodes[usize::from(node)];
        for (row, old) in state.rows.iter_mut().zip(&before.rows) {
            if old.owner == Some(node) {
                row.owner = Some(place as u8);
            }
            if let Some((former, parting)) = old.former
                && former == node
            {
                row.former = Some((place as u8, parting));
            }
        }
    }
}
