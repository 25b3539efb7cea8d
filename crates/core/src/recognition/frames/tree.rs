//! The tree that joins the sessions, along the pairs with most agreeing loops: where the search for their frames begins.

use std::cmp::Reverse;
use std::collections::BTreeMap;

use super::consensus::Consensus;
use super::measurement::Measurement;
use crate::domain::ids::SessionSeq;
use crate::geometry::Pose;

/// Two sessions, the older first.
pub type Pair = (SessionSeq, SessionSeq);

/// The place of a session in the frame of its tree's oldest session.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placed {
    /// The oldest session of the tree.
    pub root: SessionSeq,
    /// Maps points of the session's frame into the root's.
    pub root_from_session: Pose,
}

/// Joins the sessions by the pairs that most agreeing loops hold together, as long as no pair closes a circle (Kruskal). A pair of which
/// nobody can tell which loops are right joins nothing.
pub fn tree(
    sessions: &[SessionSeq],
    measured: &[Measurement],
    pairs: &BTreeMap<Pair, Consensus>,
) -> BTreeMap<SessionSeq, Placed> {
    let alone =
        |session: &SessionSeq| (*session, Placed { root: *session, root_from_session: Pose::identity() });
    let mut placed: BTreeMap<SessionSeq, Placed> = sessions.iter().map(alone).collect();
    let mut edges: Vec<(&Pair, &Consensus)> = pairs.iter().filter(|(_, of)| !of.is_tie).collect();
    edges.sort_by_key(|(pair, of)| (Reverse(of.agreeing.len()), **pair));
    for (_, of) in edges {
        let measurement = &measured[of.middle];
        let (Some(a), Some(b)) = (placed.get(&measurement.a).copied(), placed.get(&measurement.b).copied())
        else {
            continue;
        };
        if a.root == b.root {
            continue;
        }
        let a_root_from_b_root =
            a.root_from_session.after(&measurement.a_from_b).after(&b.root_from_session.inverse());
        // The older root stays.
        let (root, goes, from_going) = if a.root < b.root {
            (a.root, b.root, a_root_from_b_root)
        } else {
            (b.root, a.root, a_root_from_b_root.inverse())
        };
        for of_session in placed.values_mut().filter(|of_session| of_session.root == goes) {
            let root_from_session = from_going.after(&of_session.root_from_session);
            *of_session = Placed { root, root_from_session };
        }
    }
    placed
}
