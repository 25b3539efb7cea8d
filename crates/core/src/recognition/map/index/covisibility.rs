//! The covisibility graph: which keyframes see the same things.
//!
//! By itself no keyframe is its own neighbour; where the paper's K_k^cov must contain k (M1),
//! [`Covisibility::with_itself`] adds it.

#[cfg(test)]
mod tests;

use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};

use super::map_index::MapIndex;
use crate::domain::ids::KeyframeSeq;
use crate::recognition::map::covisibility::{Edge, Neighbour};

/// The graph of one map.
#[derive(Clone, Copy, Debug)]
pub struct Covisibility<'a> {
    index: &'a MapIndex,
}

impl MapIndex {
    /// Returns the covisibility graph.
    pub fn covisibility(&self) -> Covisibility<'_> {
        Covisibility { index: self }
    }
}

impl<'a> Covisibility<'a> {
    /// Returns the keyframes covisible with one, ascending, without itself.
    pub fn neighbours(self, keyframe: KeyframeSeq) -> impl Iterator<Item = KeyframeSeq> + use<'a> {
        self.joined(keyframe).map(|joined| joined.other)
    }

    /// Returns those that are so for another reason than a confirmed loop.
    pub fn neighbours_by_sight(self, keyframe: KeyframeSeq) -> impl Iterator<Item = KeyframeSeq> + use<'a> {
        self.joined(keyframe).filter(Joined::is_by_sight).map(|joined| joined.other)
    }

    /// K_k^cov of the paper: the neighbours and the keyframe itself.
    pub fn with_itself(self, keyframe: KeyframeSeq) -> impl Iterator<Item = KeyframeSeq> + use<'a> {
        self.neighbours(keyframe).chain(std::iter::once(keyframe))
    }

    /// Returns the number of keyframes that are covisible with one.
    pub fn degree(self, keyframe: KeyframeSeq) -> usize {
        self.joined(keyframe).count()
    }

    /// Returns the neighbours, each with its number of shared map points.
    pub fn shared(self, keyframe: KeyframeSeq) -> impl Iterator<Item = Neighbour> + use<'a> {
        self.joined(keyframe).map(|Joined { other, points, edge, .. }| {
            (other, points.max(edge.and_then(|edge| edge.declared).unwrap_or(0)))
        })
    }

    /// Returns the neighbours of a keyframe along the drive (M62), ascending.
    pub fn along_drive(self, keyframe: KeyframeSeq) -> Vec<KeyframeSeq> {
        self.index.along_drive(keyframe)
    }

    /// Returns the edge between two keyframes that is a fact, if there is one.
    pub fn edge(self, a: KeyframeSeq, b: KeyframeSeq) -> Option<Edge> {
        self.index.lists.edge(a, b)
    }

    /// Whether the two are covisible.
    pub fn joins(self, a: KeyframeSeq, b: KeyframeSeq) -> bool {
        self.index.lists.edge(a, b).is_some()
            || self.joins_by_points(a, b)
            || self.index.joins_along_drive(a, b)
    }

    /// Whether the two are covisible by what they see, by what a client declared, or along the drive, and not only by a
    /// confirmed loop.
    pub fn joins_by_sight(self, a: KeyframeSeq, b: KeyframeSeq) -> bool {
        let edge = self.index.lists.edge(a, b);
        edge.is_some_and(|edge| edge.declared.is_some())
            || self.joins_by_points(a, b)
            || self.index.joins_along_drive(a, b)
    }

    /// Returns the union of the K_k^cov of some keyframes, ascending.
    ///
    /// Where many keyframes see one place, the first of them brings nearly all of its neighbours; the union is complete
    /// once it holds every keyframe that shares any map point with any of them.
    pub fn around(self, keyframes: &BTreeSet<KeyframeSeq>) -> Vec<KeyframeSeq> {
        let lists = &self.index.lists;
        let (mut found, mut crowded) = (Vec::new(), Vec::new());
        for keyframe in keyframes {
            found.push(*keyframe);
            found.extend(lists.edges(*keyframe).iter().map(|(other, _)| *other));
            found.extend(self.index.along_drive(*keyframe));
            match lists.listed(*keyframe) {
                Some(list) => found.extend(list.iter().map(|(other, _)| *other)),
                None => crowded.push(keyframe),
            }
        }
        ascending(&mut found);
        if crowded.is_empty() {
            return found;
        }
        let mut open = self.touched_by(&crowded);
        open.retain(|other| found.binary_search(other).is_err());
        for keyframe in crowded {
            if open.is_empty() {
                break;
            }
            found.extend(
                self.sharing(*keyframe).iter().map(|(other, _)| *other).filter(|other| open.remove(other)),
            );
        }
        ascending(&mut found);
        found
    }

    /// Whether any of some keyframes is one of others, or covisible with one.
    pub fn touches(self, these: &BTreeSet<KeyframeSeq>, others: &BTreeSet<KeyframeSeq>) -> bool {
        let Some((first, last)) = others.first().zip(others.last()) else { return false };
        let lists = &self.index.lists;
        if these.iter().any(|keyframe| lists.listed(*keyframe).is_none()) {
            return self.around(these).iter().any(|keyframe| others.contains(keyframe));
        }
        // A robot's neighbours are near in number: most lists end before the others begin, or begin after they end.
        let is_other = |list: &[Neighbour]| {
            let from = list.partition_point(|(other, _)| other < first);
            let mut within = list[from..].iter().map(|(other, _)| other).take_while(|other| *other <= last);
            within.any(|other| others.contains(other))
        };
        these.iter().any(|keyframe| {
            others.contains(keyframe)
                || lists.listed(*keyframe).is_some_and(is_other)
                || lists.edges(*keyframe).iter().any(|(other, _)| others.contains(other))
                || self.index.along_drive(*keyframe).iter().any(|other| others.contains(other))
        })
    }

    /// Returns the keyframes that share any map point with any of these.
    fn touched_by(self, keyframes: &[&KeyframeSeq]) -> BTreeSet<KeyframeSeq> {
        let mut of_session: BTreeMap<_, BTreeSet<_>> = BTreeMap::new();
        for keyframe in keyframes.iter().filter_map(|keyframe| self.index.keyframe(**keyframe)) {
            of_session.entry(keyframe.session).or_default().extend(keyframe.observes.iter());
        }
        let touched = of_session
            .into_iter()
            .flat_map(|(session, points)| self.index.points.sharing(session, points))
            .map(|(other, _)| other);
        touched.collect()
    }

    /// Whether the two share enough map points.
    pub fn joins_by_points(self, a: KeyframeSeq, b: KeyframeSeq) -> bool {
        let is_in =
            |list: &[Neighbour], wanted| list.binary_search_by_key(&wanted, |(other, _)| *other).is_ok();
        match (self.index.lists.listed(a), self.index.lists.listed(b)) {
            (Some(list), _) => is_in(list, b),
            (None, Some(list)) => is_in(list, a),
            (None, None) => a != b && self.common_points(a, b, self.enough()) == self.enough(),
        }
    }

    /// Counts the map points that two keyframes of one session have in common, and stops at this many.
    pub fn common_points(self, a: KeyframeSeq, b: KeyframeSeq, most: u32) -> u32 {
        let Some((a, b)) = self.index.keyframe(a).zip(self.index.keyframe(b)) else { return 0 };
        if a.session != b.session {
            return 0;
        }
        let (mut of_a, mut of_b) = (a.observes.iter().peekable(), b.observes.iter().peekable());
        let mut common = 0;
        while common < most
            && let Some((in_a, in_b)) = of_a.peek().zip(of_b.peek())
        {
            let order = in_a.cmp(in_b);
            common += u32::from(order.is_eq());
            if order.is_le() {
                of_a.next();
            }
            if order.is_ge() {
                of_b.next();
            }
        }
        common
    }

    /// Returns the number of common map points that makes two keyframes covisible.
    pub fn enough(self) -> u32 {
        self.index.properties.settings.covisibility_min_shared_points
    }

    /// Returns the keyframes that share enough map points with one, ascending, each with how many.
    pub(super) fn sharing(self, keyframe: KeyframeSeq) -> Cow<'a, [Neighbour]> {
        match self.index.lists.listed(keyframe) {
            Some(list) => Cow::Borrowed(list),
            None => Cow::Owned(self.counted(keyframe)),
        }
    }

    /// Returns the same, counted from the map points.
    pub(super) fn counted(self, keyframe: KeyframeSeq) -> Vec<Neighbour> {
        let Some(stored) = self.index.keyframe(keyframe) else { return Vec::new() };
        let mut sharing = self.index.points.sharing(stored.session, stored.observes.iter());
        sharing.retain(|(other, points)| *other != keyframe && *points >= self.enough());
        sharing
    }

    /// Returns the neighbours, ascending.
    fn joined(self, keyframe: KeyframeSeq) -> impl Iterator<Item = Joined> + use<'a> {
        let (sharing, edges) = (self.sharing(keyframe), self.index.lists.edges(keyframe));
        let along_drive = self.index.along_drive(keyframe);
        let (mut at, mut at_edge, mut at_drive) = (0, 0, 0);
        std::iter::from_fn(move || {
            let neighbour = sharing.get(at).copied();
            let (edge, on_drive) = (edges.get(at_edge).copied(), along_drive.get(at_drive).copied());
            let known = [neighbour.map(|(other, _)| other), edge.map(|(other, _)| other), on_drive];
            let other = known.into_iter().flatten().min()?;
            let neighbour = neighbour.filter(|(of, _)| *of == other);
            let edge = edge.filter(|(of, _)| *of == other).map(|(_, edge)| edge);
            let is_on_drive = on_drive == Some(other);
            at += usize::from(neighbour.is_some());
            at_edge += usize::from(edge.is_some());
            at_drive += usize::from(is_on_drive);
            Some(Joined { other, points: neighbour.map_or(0, |(_, points)| points), edge, is_on_drive })
        })
    }
}

/// A neighbour, and why it is one.
struct Joined {
    other: KeyframeSeq,
    /// The map points it shares, if they are enough; else 0.
    points: u32,
    /// The edge that is a fact.
    edge: Option<Edge>,
    /// Whether it is near along the drive (M62).
    is_on_drive: bool,
}

impl Joined {
    fn is_by_sight(&self) -> bool {
        self.points > 0 || self.is_on_drive || self.edge.is_some_and(|edge| edge.declared.is_some())
    }
}

/// Sorts keyframes, and leaves each once.
fn ascending(keyframes: &mut Vec<KeyframeSeq>) {
    keyframes.sort_unstable();
    keyframes.dedup();
}
