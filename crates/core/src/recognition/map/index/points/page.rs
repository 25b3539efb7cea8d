//! A page: up to 64 map points of one session, numbered one after the other.
//!
//! Robots number their points as they make them, so nearly every page is full, and what a point needs beyond its
//! position and its observers is a few bits. A point numbered far from all others takes a page of its own.

use super::observers;
use crate::domain::ids::{KeyframeSeq, PointId};
use crate::domain::varint;
use crate::geometry::Point3;

/// Points of a page: one bit of a word each.
const POINTS: PointId = 64;

/// Returns the page of a point.
pub(super) fn of(id: PointId) -> i64 {
    id.div_euclid(POINTS)
}

/// Returns the bit of a point within its page.
pub(super) fn bit(id: PointId) -> u64 {
    1 << id.rem_euclid(POINTS)
}

/// Some points that follow each other. Equal pages hold the same points with the same observers: nothing in here
/// depends on the order of arrival.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Page {
    /// The points that have a position.
    placed: u64,
    /// Their positions in the session's frame, in the order of their numbers.
    positions: Vec<Point3>,
    /// The points that are observed.
    observed: u64,
    /// Of each in the order of their numbers: how many bytes its list of observers takes, and the list.
    observers: Box<[u8]>,
}

impl Page {
    /// Returns the position of a point.
    pub(super) fn position(&self, bit: u64) -> Option<Point3> {
        (self.placed & bit != 0).then(|| self.positions[rank(self.placed, bit)])
    }

    /// Sets a position, and returns whether there was none.
    pub(super) fn place(&mut self, bit: u64, position: Point3) -> bool {
        let at = rank(self.placed, bit);
        if self.placed & bit != 0 {
            self.positions[at] = position;
            return false;
        }
        self.positions.reserve_exact(1);
        self.positions.insert(at, position);
        self.placed |= bit;
        true
    }

    /// Removes a position, and returns whether there was one.
    pub(super) fn displace(&mut self, bit: u64) -> bool {
        let had = self.placed & bit != 0;
        if had {
            self.positions.remove(rank(self.placed, bit));
            self.positions.shrink_to_fit();
            self.placed &= !bit;
        }
        had
    }

    /// Returns the points of this page, which has a number, that have a position, ascending.
    pub(super) fn placed(&self, number: i64) -> impl Iterator<Item = (PointId, Point3)> {
        let ids = bits(self.placed).map(move |bit| number * POINTS + PointId::from(bit.trailing_zeros()));
        ids.zip(self.positions.iter().copied())
    }

    /// Whether a point has observers.
    pub(super) fn is_observed(&self, bit: u64) -> bool {
        self.observed & bit != 0
    }

    /// Whether nothing is known of any of its points.
    pub(super) fn is_empty(&self) -> bool {
        self.placed | self.observed == 0
    }

    /// Makes a keyframe an observer of some points.
    pub(super) fn observe(&mut self, points: u64, keyframe: KeyframeSeq) {
        self.rewrite(points, |list, written| observers::add(list, keyframe.0, written));
    }

    /// Removes a keyframe from the observers of some points.
    pub(super) fn forget(&mut self, points: u64, keyframe: KeyframeSeq) {
        self.rewrite(points, |list, written| observers::remove(list, keyframe.0, written));
    }

    /// Appends the observers of some points, each as often as it observes one of them.
    pub(super) fn observers(&self, points: u64, found: &mut Vec<u32>) {
        for (bit, list) in self.lists(self.observed) {
            if points & bit != 0 {
                found.extend(observers::read(list));
            }
        }
    }

    /// Counts those of some points that are observed by a keyframe of which `counts` is true.
    pub(super) fn count_observed(&self, points: u64, counts: &impl Fn(KeyframeSeq) -> bool) -> usize {
        let lists = self.lists(self.observed).filter(|(bit, _)| points & bit != 0);
        lists.filter(|(_, list)| observers::read(list).any(|keyframe| counts(KeyframeSeq(keyframe)))).count()
    }

    /// Bytes on the heap.
    pub(super) fn heap_bytes(&self) -> usize {
        self.positions.capacity() * size_of::<Point3>() + self.observers.len()
    }

    /// Returns the lists of these points, empty for one that is not observed.
    fn lists(&self, points: u64) -> impl Iterator<Item = (u64, &[u8])> {
        let mut rest = &*self.observers;
        bits(points).map(move |bit| {
            if self.observed & bit == 0 {
                return (bit, &[][..]);
            }
            let length = varint::read(&mut rest).unwrap_or_default() as usize;
            let (list, others) = rest.split_at(length.min(rest.len()));
            rest = others;
            (bit, list)
        })
    }

    fn rewrite(&mut self, points: u64, edit: impl Fn(&[u8], &mut Vec<u8>)) {
        let mut written = Vec::with_capacity(self.observers.len() + 4 * points.count_ones() as usize);
        let (mut observed, mut edited) = (0, Vec::new());
        for (bit, list) in self.lists(self.observed | points) {
            let list = if points & bit == 0 {
                list
            } else {
                edited.clear();
                edit(list, &mut edited);
                &*edited
            };
            if !list.is_empty() {
                varint::write(list.len() as u64, &mut written);
                written.extend_from_slice(list);
                observed |= bit;
            }
        }
        (self.observed, self.observers) = (observed, written.into());
    }
}

fn rank(points: u64, bit: u64) -> usize {
    (points & (bit - 1)).count_ones() as usize
}

fn bits(mut points: u64) -> impl Iterator<Item = u64> {
    std::iter::from_fn(move || {
        let bit = points & points.wrapping_neg();
        points ^= bit;
        (bit != 0).then_some(bit)
    })
}
