//! The map points of every session: where they are, and which keyframes observe them.
//!
//! A point may be observed before it has a position (not triangulated yet), and have a position before a keyframe
//! observes it.

mod observers;
mod page;
#[cfg(test)]
mod tests;

use std::collections::HashMap;

use foldhash::fast::RandomState;

use self::page::Page;
use crate::domain::ids::{KeyframeSeq, PointId, SessionSeq};
use crate::geometry::Point3;

/// All map points of a map; numbers collide between sessions on purpose.
#[derive(Clone, Debug, Default)]
pub struct Points {
    pages: HashMap<(SessionSeq, i64), Page, RandomState>,
    /// How many have a position.
    placed: u64,
    /// Bytes of the pages on the heap.
    page_bytes: usize,
}

/// What a map point with a position takes on disk, in bytes: its number and three floats.
pub const POINT_BYTES: u64 = (size_of::<PointId>() + 3 * size_of::<f64>()) as u64;

/// Counters are kept for a whole range of keyframes when it is at most this many times as long as what is counted;
/// a wider range is sorted instead.
const SPREAD: usize = 8;

impl Points {
    /// Returns the point's position in its session's frame, if it has one.
    pub fn position(&self, session: SessionSeq, id: PointId) -> Option<Point3> {
        self.pages.get(&(session, page::of(id)))?.position(page::bit(id))
    }

    /// Returns what the points that have a position take on disk, in bytes. Those without one are numbers in keyframes.
    pub fn bytes(&self) -> u64 {
        self.placed * POINT_BYTES
    }

    /// Bytes on the heap, without the allocator's own.
    pub fn heap_bytes(&self) -> usize {
        // The standard hash map fills at most 7/8 of its buckets; a bucket is an entry and a control byte.
        let bucket = size_of::<((SessionSeq, i64), Page)>() + 1;
        self.pages.capacity() / 7 * 8 * bucket + self.page_bytes
    }

    /// Whether a keyframe observes the point.
    pub fn is_observed(&self, session: SessionSeq, id: PointId) -> bool {
        self.pages.get(&(session, page::of(id))).is_some_and(|page| page.is_observed(page::bit(id)))
    }

    /// Returns the keyframes that observe some of these points, ascending, each with how many.
    pub fn sharing(
        &self,
        session: SessionSeq,
        ids: impl IntoIterator<Item = PointId>,
    ) -> Vec<(KeyframeSeq, u32)> {
        let mut observers = Vec::new();
        for (page, points) in by_page(ids) {
            if let Some(page) = self.pages.get(&(session, page)) {
                page.observers(points, &mut observers);
            }
        }
        counted(observers)
    }

    /// Counts those of these points that are observed by a keyframe of which `counts` is true.
    pub fn count_observed(
        &self,
        session: SessionSeq,
        ids: impl IntoIterator<Item = PointId>,
        counts: impl Fn(KeyframeSeq) -> bool,
    ) -> usize {
        let of_page = |(page, points)| {
            let page = self.pages.get(&(session, page));
            page.map_or(0, |page| page.count_observed(points, &counts))
        };
        by_page(ids).into_iter().map(of_page).sum()
    }

    /// Returns the points of a session that have a position, ascending.
    pub fn placed(&self, session: SessionSeq) -> Vec<(PointId, Point3)> {
        let of_session = self.pages.iter().filter(|((of, _), _)| *of == session);
        let mut placed: Vec<(PointId, Point3)> =
            of_session.flat_map(|((_, number), page)| page.placed(*number)).collect();
        placed.sort_unstable_by_key(|(id, _)| *id);
        placed
    }

    /// Sets the point's position.
    pub fn set_position(&mut self, session: SessionSeq, id: PointId, position_in_session: Point3) {
        let is_new =
            self.change((session, page::of(id)), |page| page.place(page::bit(id), position_in_session));
        self.placed += u64::from(is_new);
    }

    /// Removes the point's position.
    pub fn clear_position(&mut self, session: SessionSeq, id: PointId) {
        let had_one = self.change((session, page::of(id)), |page| page.displace(page::bit(id)));
        self.placed -= u64::from(had_one);
    }

    /// Makes a keyframe an observer of these points.
    pub fn observe(
        &mut self,
        session: SessionSeq,
        ids: impl IntoIterator<Item = PointId>,
        keyframe: KeyframeSeq,
    ) {
        for (page, points) in by_page(ids) {
            self.change((session, page), |page| page.observe(points, keyframe));
        }
    }

    /// Removes a keyframe that observed these points. A point that has neither position nor observer is no fact of the
    /// map any more.
    pub fn forget(
        &mut self,
        session: SessionSeq,
        ids: impl IntoIterator<Item = PointId>,
        keyframe: KeyframeSeq,
    ) {
        for (page, points) in by_page(ids) {
            self.change((session, page), |page| page.forget(points, keyframe));
        }
    }

    fn change<T>(&mut self, at: (SessionSeq, i64), change: impl FnOnce(&mut Page) -> T) -> T {
        let page = self.pages.entry(at).or_default();
        let before = page.heap_bytes();
        let result = change(page);
        self.page_bytes = self.page_bytes - before + page.heap_bytes();
        if page.is_empty() {
            self.pages.remove(&at);
        }
        result
    }
}

/// Equal when they hold the same points; bytes on the heap depend on how they came about.
impl PartialEq for Points {
    fn eq(&self, other: &Self) -> bool {
        self.pages == other.pages
    }
}

/// Returns the points of each page, one bit each.
fn by_page(ids: impl IntoIterator<Item = PointId>) -> Vec<(i64, u64)> {
    let mut pages: Vec<(i64, u64)> = Vec::new();
    let mut is_sorted = true;
    for id in ids {
        match pages.last_mut() {
            Some((last, points)) if *last == page::of(id) => *points |= page::bit(id),
            last => {
                is_sorted &= last.is_none_or(|(last, _)| *last < page::of(id));
                pages.push((page::of(id), page::bit(id)));
            }
        }
    }
    if !is_sorted {
        pages.sort_unstable_by_key(|(page, _)| *page);
        pages.dedup_by(|next, kept| {
            let is_same = next.0 == kept.0;
            kept.1 |= if is_same { next.1 } else { 0 };
            is_same
        });
    }
    pages
}

/// Each keyframe once, ascending, with how often it was there.
fn counted(mut observers: Vec<u32>) -> Vec<(KeyframeSeq, u32)> {
    let (Some(&low), Some(&high)) = (observers.iter().min(), observers.iter().max()) else {
        return Vec::new();
    };
    if ((high - low) as usize) < SPREAD * observers.len() {
        let mut counts = vec![0_u32; (high - low) as usize + 1];
        for keyframe in &observers {
            counts[(keyframe - low) as usize] += 1;
        }
        let found = (low..=high).zip(counts).filter(|(_, count)| *count > 0);
        return found.map(|(keyframe, count)| (KeyframeSeq(keyframe), count)).collect();
    }
    observers.sort_unstable();
    observers.chunk_by(u32::eq).map(|same| (KeyframeSeq(same[0]), same.len() as u32)).collect()
}
