//! What is kept of the covisibility graph: short lists of neighbours, and the edges that are facts.
//!
//! Two keyframes are covisible when they are of one session and observe enough common map
//! points (ORB-SLAM's graph), when a client declared it, or when a confirmed loop joins them
//! (M12). The relation is symmetric; [`super::index::Covisibility`] answers questions about it.
//!
//! Common map points follow from the keyframes, so their edges are kept only to be fast, and only where they are few:
//! n keyframes that see the same place would list n² of them. A keyframe with more than a bounded number of neighbours
//! is *crowded*: it lists none, and its neighbours are counted from the points whenever they are asked for.

use super::dense_map::DenseMap;
use crate::domain::ids::KeyframeSeq;

/// The most neighbours by shared points that a keyframe lists: several times as many as on a robot's way, and 2 KiB. In
/// this crate's own tests two, so that the laws of maps hold across the bound as well.
const LISTED_MAX: usize = if cfg!(test) { 2 } else { 256 };

/// A keyframe and the number of map points that it shares with another.
pub type Neighbour = (KeyframeSeq, u32);

/// Facts that make two keyframes covisible.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Edge {
    /// The number of shared points that the client declared, if it did.
    pub declared: Option<u32>,
    /// How many confirmed loops join the two.
    pub loops: u32,
}

impl Edge {
    fn holds(self) -> bool {
        self.declared.is_some() || self.loops > 0
    }
}

/// The neighbours of a keyframe by shared points.
#[derive(Clone, Debug)]
enum Sharing {
    /// All of them, ascending.
    Listed(Vec<Neighbour>),
    /// Too many to be listed. A crowded keyframe stays so.
    Crowded,
}

/// The lists and edges of one map, by dense keyframe number.
#[derive(Clone, Debug)]
pub struct CovisibilityLists {
    listed_max: usize,
    /// A keyframe without neighbours has no list.
    sharing: DenseMap<Sharing>,
    /// Ascending, at both ends; a keyframe without edges has no list.
    edges: DenseMap<Vec<(KeyframeSeq, Edge)>>,
    /// Entries of all lists and edges.
    entries: u64,
}

impl Default for CovisibilityLists {
    fn default() -> Self {
        Self::listing(LISTED_MAX)
    }
}

impl CovisibilityLists {
    /// Lists of at most this many neighbours each.
    pub fn listing(listed_max: usize) -> Self {
        Self { listed_max, sharing: DenseMap::default(), edges: DenseMap::default(), entries: 0 }
    }

    /// Returns the entries of all lists and edges; an edge has one at either end.
    pub fn entry_count(&self) -> u64 {
        self.entries
    }

    /// Returns the neighbours of a keyframe by shared points, ascending; `None` if they are not listed.
    pub fn listed(&self, keyframe: KeyframeSeq) -> Option<&[Neighbour]> {
        match self.sharing.get(keyframe.index()) {
            None => Some(&[]),
            Some(Sharing::Listed(list)) => Some(list),
            Some(Sharing::Crowded) => None,
        }
    }

    /// Returns the edges of a keyframe that are facts, ascending.
    pub fn edges(&self, keyframe: KeyframeSeq) -> &[(KeyframeSeq, Edge)] {
        self.edges.get(keyframe.index()).map_or(&[], Vec::as_slice)
    }

    /// Returns the edge between two keyframes, if there is one that is a fact.
    pub fn edge(&self, a: KeyframeSeq, b: KeyframeSeq) -> Option<Edge> {
        let edges = self.edges(a);
        edges.binary_search_by_key(&b, |(other, _)| *other).ok().map(|at| edges[at].1)
    }

    /// Adds a keyframe that shares points with these neighbours, ascending.
    pub fn add(&mut self, keyframe: KeyframeSeq, neighbours: &[Neighbour]) {
        for (other, points) in neighbours {
            self.meet(*other, (keyframe, *points));
        }
        if neighbours.len() > self.listed_max {
            self.sharing.insert(keyframe.index(), Sharing::Crowded);
        } else if !neighbours.is_empty() {
            self.entries += neighbours.len() as u64;
            self.sharing.insert(keyframe.index(), Sharing::Listed(neighbours.to_vec()));
        }
    }

    /// Tells a keyframe that lists its neighbours how many points it shares with another one now; `None` if too few.
    pub fn share(&mut self, keyframe: KeyframeSeq, other: KeyframeSeq, points: Option<u32>) {
        match points {
            Some(points) => self.meet(keyframe, (other, points)),
            None => self.part(keyframe, other),
        }
    }

    fn meet(&mut self, keyframe: KeyframeSeq, neighbour: Neighbour) {
        let max = self.listed_max;
        let sharing = self.sharing.get_or_insert_with(keyframe.index(), || Sharing::Listed(Vec::new()));
        let Sharing::Listed(list) = sharing else { return };
        match list.binary_search_by_key(&neighbour.0, |(other, _)| *other) {
            Ok(at) => list[at] = neighbour,
            Err(at) => {
                self.entries += 1;
                list.insert(at, neighbour);
            }
        }
        if list.len() > max {
            self.entries -= list.len() as u64;
            *sharing = Sharing::Crowded;
        }
    }

    /// Lists a keyframe's neighbours by shared points anew: before, it had others.
    pub fn relist(&mut self, keyframe: KeyframeSeq, before: &[Neighbour], now: &[Neighbour]) {
        self.unlist(keyframe, before);
        self.add(keyframe, now);
    }

    /// Removes a keyframe with its edges; these are its neighbours by shared points.
    pub fn remove(&mut self, keyframe: KeyframeSeq, neighbours: &[Neighbour]) {
        self.unlist(keyframe, neighbours);
        let edges = self.edges.remove(keyframe.index()).unwrap_or_default();
        self.entries -= edges.len() as u64;
        for (other, _) in edges {
            self.change_list(other, |list| list.retain(|(back, _)| *back != keyframe));
        }
    }

    /// Takes a keyframe from the lists of neighbours by shared points; these are its own.
    fn unlist(&mut self, keyframe: KeyframeSeq, neighbours: &[Neighbour]) {
        if let Some(Sharing::Listed(list)) = self.sharing.remove(keyframe.index()) {
            self.entries -= list.len() as u64;
        }
        for (other, _) in neighbours {
            self.part(*other, keyframe);
        }
    }

    fn part(&mut self, keyframe: KeyframeSeq, other: KeyframeSeq) {
        let Some(Sharing::Listed(list)) = self.sharing.get_mut(keyframe.index()) else { return };
        if let Ok(at) = list.binary_search_by_key(&other, |(listed, _)| *listed) {
            list.remove(at);
            self.entries -= 1;
        }
        if list.is_empty() {
            self.sharing.remove(keyframe.index());
        }
    }

    /// Forgets every list of neighbours by shared points: another number of them is enough now.
    pub fn clear_sharing(&mut self) {
        let listed = |sharing: &Sharing| match sharing {
            Sharing::Listed(list) => list.len() as u64,
            Sharing::Crowded => 0,
        };
        self.entries -= self.sharing.values().map(listed).sum::<u64>();
        self.sharing = DenseMap::default();
    }

    /// A client declares the two covisible. Declared from both sides, the larger number stands.
    pub fn declare(&mut self, a: KeyframeSeq, b: KeyframeSeq, shared: u32) {
        self.change(a, b, |edge| edge.declared = edge.declared.max(Some(shared)));
    }

    /// A client declares the two covisible with this number of shared points, whatever was declared before.
    pub fn redeclare(&mut self, a: KeyframeSeq, b: KeyframeSeq, shared: u32) {
        self.change(a, b, |edge| edge.declared = Some(shared));
    }

    /// A confirmed loop joins the two.
    pub fn join_by_loop(&mut self, a: KeyframeSeq, b: KeyframeSeq) {
        self.change(a, b, |edge| edge.loops += 1);
    }

    /// A loop that joined the two was revoked.
    pub fn part_by_loop(&mut self, a: KeyframeSeq, b: KeyframeSeq) {
        self.change(a, b, |edge| edge.loops = edge.loops.saturating_sub(1));
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
        let list = self.edges.get_or_insert_with(of.index(), Vec::new);
        let before = list.len() as u64;
        change(list);
        self.entries = self.entries + list.len() as u64 - before;
        if list.is_empty() {
            self.edges.remove(of.index());
        }
    }
}

/// Equal when the facts are, and the lists that both have. What only one of them lists follows from the map points;
/// whoever compares two maps compares those as well.
impl PartialEq for CovisibilityLists {
    fn eq(&self, other: &Self) -> bool {
        let agrees = |ours: &Self, theirs: &Self| {
            ours.sharing.iter().all(|(number, _)| {
                let keyframe = KeyframeSeq(number as u32);
                let both = ours.listed(keyframe).zip(theirs.listed(keyframe));
                both.is_none_or(|(a, b)| a == b)
            })
        };
        self.edges == other.edges && agrees(self, other) && agrees(other, self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const A: KeyframeSeq = KeyframeSeq(0);
    const B: KeyframeSeq = KeyframeSeq(1);

    #[test]
    fn an_edge_stands_as_long_as_one_reason_for_it_does() {
        let mut graph = CovisibilityLists::default();
        graph.join_by_loop(A, B);
        graph.declare(A, B, 20);
        graph.part_by_loop(B, A);
        assert!(graph.edge(A, B).is_some() && graph.edge(B, A).is_some());
        let mut other = CovisibilityLists::default();
        other.declare(B, A, 20);
        assert_eq!(graph, other);
    }

    #[test]
    fn a_removed_keyframe_leaves_no_edge_behind() {
        let mut graph = CovisibilityLists::default();
        graph.declare(A, B, 0);
        graph.add(B, &[(A, 15)]);
        graph.remove(A, &[(B, 15)]);
        assert!(graph.edges(B).is_empty());
        assert_eq!(graph.listed(B), Some(&[][..]));
        assert_eq!(graph, CovisibilityLists::default());
    }
}
