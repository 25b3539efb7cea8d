//! The covisibility graph: which keyframes see the same things.
//!
//! Two keyframes are covisible when they are of one session and observe enough common map
//! points (ORB-SLAM's graph), when a client declared it, or when a confirmed loop joins them
//! (`contract.md` §8.12). The relation is symmetric. By itself no keyframe is its own
//! neighbour; where the paper's K_k^cov must contain k (§8.1), [`Covisibility::with_itself`] adds it.

use super::numbered::Numbered;
use crate::model::ids::KeyframeSeq;

/// Why two keyframes are covisible.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Edge {
    /// Common map points, if there are enough of them.
    points: u32,
    /// The number the client declared, if it did.
    declared: Option<u32>,
    /// How many confirmed loops join the two.
    loops: u32,
}

impl Edge {
    fn holds(self) -> bool {
        self.points > 0 || self.declared.is_some() || self.loops > 0
    }

    fn shared(self) -> u32 {
        self.points.max(self.declared.unwrap_or(0))
    }
}

/// The graph of one map, by dense keyframe number.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Covisibility {
    /// Ascending; a keyframe without edges has no list.
    edges: Numbered<Vec<(KeyframeSeq, Edge)>>,
    /// Entries of all lists.
    count: u64,
}

impl Covisibility {
    /// The keyframes covisible with one, ascending, without itself.
    pub fn neighbours(&self, keyframe: KeyframeSeq) -> impl Iterator<Item = KeyframeSeq> + '_ {
        self.edges.get(keyframe.index()).into_iter().flatten().map(|(other, _)| *other)
    }

    /// How many edges there are, each told from both of its ends.
    pub fn edge_count(&self) -> u64 {
        self.count
    }

    /// K_k^cov of the paper: the neighbours and the keyframe itself.
    pub fn with_itself(&self, keyframe: KeyframeSeq) -> impl Iterator<Item = KeyframeSeq> + '_ {
        self.neighbours(keyframe).chain(std::iter::once(keyframe))
    }

    /// How many keyframes are covisible with one.
    pub fn degree(&self, keyframe: KeyframeSeq) -> usize {
        self.edges.get(keyframe.index()).map_or(0, Vec::len)
    }

    /// The neighbours, each with its number of shared map points.
    pub fn shared(&self, keyframe: KeyframeSeq) -> impl Iterator<Item = (KeyframeSeq, u32)> + '_ {
        self.edges.get(keyframe.index()).into_iter().flatten().map(|(other, edge)| (*other, edge.shared()))
    }

    /// The keyframes of its session that share enough map points with one.
    pub fn sharing_points(&self, keyframe: KeyframeSeq) -> impl Iterator<Item = KeyframeSeq> + '_ {
        let edges = self.edges.get(keyframe.index()).into_iter().flatten();
        edges.filter(|(_, edge)| edge.points > 0).map(|(other, _)| *other)
    }

    /// Are the two covisible?
    pub fn joins(&self, a: KeyframeSeq, b: KeyframeSeq) -> bool {
        self.edges
            .get(a.index())
            .is_some_and(|list| list.binary_search_by_key(&b, |(other, _)| *other).is_ok())
    }

    /// Are the two covisible by what they see, or by what a client declared, and not only by a confirmed loop?
    pub fn joins_by_sight(&self, a: KeyframeSeq, b: KeyframeSeq) -> bool {
        let edges = self.edges.get(a.index()).map_or(&[][..], Vec::as_slice);
        let edge = edges.binary_search_by_key(&b, |(other, _)| *other).ok().map(|at| edges[at].1);
        edge.is_some_and(|edge| edge.points > 0 || edge.declared.is_some())
    }

    /// The two observe this many common map points, which is enough.
    pub fn share_points(&mut self, a: KeyframeSeq, b: KeyframeSeq, points: u32) {
        self.change(a, b, |edge| edge.points = points);
    }

    /// A client declares the two covisible. Declared from both sides, the larger number stands.
    pub fn declare(&mut self, a: KeyframeSeq, b: KeyframeSeq, shared: u32) {
        self.change(a, b, |edge| edge.declared = edge.declared.max(Some(shared)));
    }

    /// A confirmed loop joins the two.
    pub fn join_by_loop(&mut self, a: KeyframeSeq, b: KeyframeSeq) {
        self.change(a, b, |edge| edge.loops += 1);
    }

    /// A loop that joined the two was revoked.
    pub fn part_by_loop(&mut self, a: KeyframeSeq, b: KeyframeSeq) {
        self.change(a, b, |edge| edge.loops = edge.loops.saturating_sub(1));
    }

    /// A keyframe is gone, with its edges.
    pub fn remove(&mut self, keyframe: KeyframeSeq) {
        let edges = self.edges.remove(keyframe.index()).unwrap_or_default();
        self.count -= edges.len() as u64;
        for (other, _) in edges {
            self.change_list(other, |list| list.retain(|(back, _)| *back != keyframe));
        }
    }

    /// Changes the edge between two keyframes, in both directions.
    fn change(&mut self, a: KeyframeSeq, b: KeyframeSeq, change: impl Fn(&mut Edge)) {
        if a == b {
            return;
        }
        for (from, to) in [(a, b), (b, a)] {
            self.change_list(from, |list| match list.binary_search_by_key(&to, |(other, _)| *other) {
                Ok(at) => {
                    change(&mut list[at].1);
                    if !list[at].1.holds() {
                        list.remove(at);
                    }
                }
                Err(at) => {
                    let mut edge = Edge::default();
                    change(&mut edge);
                    if edge.holds() {
                        list.insert(at, (to, edge));
                    }
                }
            });
        }
    }

    fn change_list(&mut self, of: KeyframeSeq, change: impl FnOnce(&mut Vec<(KeyframeSeq, Edge)>)) {
        let list = self.edges.get_or_default(of.index());
        let before = list.len() as u64;
        change(list);
        self.count = self.count + list.len() as u64 - before;
        if list.is_empty() {
            self.edges.remove(of.index());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const A: KeyframeSeq = KeyframeSeq(0);
    const B: KeyframeSeq = KeyframeSeq(1);

    #[test]
    fn an_edge_stands_as_long_as_one_reason_for_it_does() {
        let mut graph = Covisibility::default();
        graph.join_by_loop(A, B);
        graph.share_points(A, B, 20);
        graph.part_by_loop(B, A);
        assert!(graph.joins(A, B) && graph.joins(B, A));
        let mut other = Covisibility::default();
        other.share_points(B, A, 20);
        assert_eq!(graph, other);
    }

    #[test]
    fn a_keyframe_is_not_its_own_neighbour_but_belongs_to_its_covisible_set() {
        let mut graph = Covisibility::default();
        graph.declare(A, A, 9);
        assert_eq!(graph.neighbours(A).count(), 0);
        assert_eq!(graph.with_itself(A).collect::<Vec<_>>(), [A]);
    }

    #[test]
    fn a_removed_keyframe_leaves_no_edge_behind() {
        let mut graph = Covisibility::default();
        graph.declare(A, B, 0);
        graph.remove(A);
        assert_eq!(graph.degree(B), 0);
    }
}
