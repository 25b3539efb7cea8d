//! The odometer: the way that each session was tracked, without a break (M15).
//!
//! The keyframes of a session follow each other by stamp, then by id. Two that follow each other form a *step* while they
//! share `covisibility_min_shared_points` map points; where they do not, tracking may have been lost in between, and the way
//! is broken. What a client declares and what loops join says nothing of the way.
//!
//! Lengths are whole micrometres, so that a sum is the same in whatever order it is taken. Keyframes lie in blocks that know
//! their own sum: a change costs a block, and a question about two keyframes the number of blocks.

use std::cmp::Ordering;
use std::collections::BTreeMap;

use crate::domain::change::Keyframe;
use crate::domain::ids::{KeyframeId, KeyframeSeq, SessionSeq};
use crate::domain::keyframe::Stamp;
use crate::recognition::map::dense_map::DenseMap;

/// Keyframes of a block: enough that blocks are few, and few enough to be moved along at an insert.
const BLOCK_MAX: usize = if cfg!(test) { 4 } else { 512 };

/// Micrometres of a metre.
pub const UM_PER_M: f64 = 1e6;

/// The ways of all sessions.
#[derive(Clone, Debug, Default)]
pub struct Odometer {
    pub(super) sessions: BTreeMap<SessionSeq, Vec<Block>>,
}

/// The place of a keyframe on its session's way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Milestone {
    session: SessionSeq,
    /// The breaks before it.
    breaks: usize,
    /// The way driven before it, in micrometres.
    way_um: u64,
}

impl Milestone {
    /// Returns the way between two keyframes, in metres; none if it is broken, or they are of different sessions.
    pub fn way_to_m(&self, other: &Self) -> Option<f64> {
        let is_unbroken = (self.session, self.breaks) == (other.session, other.breaks);
        is_unbroken.then(|| self.way_um.abs_diff(other.way_um) as f64 / UM_PER_M)
    }
}

/// Keyframes that follow each other.
#[derive(Clone, Debug, Default)]
pub(super) struct Block {
    pub(super) steps: Vec<Step>,
    /// The sums over its steps.
    breaks: usize,
    way_um: u64,
}

/// A keyframe, and the step that leads to it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Step {
    pub(super) keyframe: KeyframeSeq,
    /// The length of the step from the keyframe before, in micrometres; none where the way is broken, or begins.
    pub(super) way_um: Option<u64>,
}

/// Measures the step between two keyframes, in micrometres; none where tracking may have been lost.
pub(super) type Measure<'a> = &'a dyn Fn(KeyframeSeq, KeyframeSeq) -> Option<u64>;

/// A place in the blocks of a session.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Place {
    pub(super) block: usize,
    pub(super) at: usize,
}

impl Place {
    /// Returns the place after it in its block, or the end of that.
    pub(super) fn next(self) -> Self {
        Self { at: self.at + 1, ..self }
    }
}

impl Odometer {
    /// Whether a session has more than one keyframe.
    pub(super) fn has_way(&self, session: SessionSeq) -> bool {
        self.sessions
            .get(&session)
            .is_some_and(|blocks| blocks.iter().flat_map(|block| &block.steps).nth(1).is_some())
    }

    /// Returns the blocks of a keyframe's session and its place there.
    pub(super) fn place(
        &self,
        keyframe: &Keyframe,
        keyframes: &DenseMap<Keyframe>,
    ) -> Option<(&[Block], Place)> {
        let blocks = self.sessions.get(&keyframe.session)?;
        Some((blocks, find(blocks, keyframe.stamp, &keyframe.id, keyframes).ok()?))
    }

    /// Returns where a keyframe stands on its session's way.
    pub(super) fn milestone(&self, keyframe: &Keyframe, keyframes: &DenseMap<Keyframe>) -> Option<Milestone> {
        let (blocks, place) = self.place(keyframe, keyframes)?;
        let (before, rest) = blocks.split_at(place.block);
        let own = &rest.first()?.steps[..=place.at];
        let breaks = before.iter().map(|block| block.breaks).sum::<usize>()
            + own.iter().filter(|step| step.way_um.is_none()).count();
        let way_um = before.iter().map(|block| block.way_um).sum::<u64>()
            + own.iter().filter_map(|step| step.way_um).sum::<u64>();
        Some(Milestone { session: keyframe.session, breaks, way_um })
    }

    /// Adds a keyframe to its session's way.
    pub(super) fn add(&mut self, keyframe: &Keyframe, keyframes: &DenseMap<Keyframe>, measure: Measure<'_>) {
        let blocks = self.sessions.entry(keyframe.session).or_default();
        if blocks.is_empty() {
            blocks.push(Block::default());
        }
        let Err(place) = find(blocks, keyframe.stamp, &keyframe.id, keyframes) else { return };
        blocks[place.block].insert(place.at, Step { keyframe: keyframe.seq, way_um: None });
        measure_around(blocks, place, measure);
        split(blocks, place.block);
    }

    /// Removes a keyframe from its session's way; the one after it follows the one before it.
    pub(super) fn remove(
        &mut self,
        keyframe: &Keyframe,
        keyframes: &DenseMap<Keyframe>,
        measure: Measure<'_>,
    ) {
        let Some(blocks) = self.sessions.get_mut(&keyframe.session) else { return };
        let Ok(mut place) = find(blocks, keyframe.stamp, &keyframe.id, keyframes) else { return };
        blocks[place.block].remove(place.at);
        if blocks[place.block].steps.is_empty() {
            blocks.remove(place.block);
        } else if place.at == blocks[place.block].steps.len() {
            place = Place { block: place.block + 1, at: 0 };
        }
        if place.block < blocks.len() {
            measure_step(blocks, place, measure);
        } else if blocks.is_empty() {
            self.sessions.remove(&keyframe.session);
        }
    }

    /// Measures the steps from and to a keyframe again.
    pub(super) fn moved(
        &mut self,
        keyframe: &Keyframe,
        keyframes: &DenseMap<Keyframe>,
        measure: Measure<'_>,
    ) {
        let Some(blocks) = self.sessions.get_mut(&keyframe.session) else { return };
        if let Ok(place) = find(blocks, keyframe.stamp, &keyframe.id, keyframes) {
            measure_around(blocks, place, measure);
        }
    }

    fn steps(&self) -> impl Iterator<Item = (SessionSeq, &Step)> {
        self.sessions.iter().flat_map(|(session, blocks)| {
            let steps = blocks.iter().flat_map(|block| &block.steps);
            steps.map(move |step| (*session, step))
        })
    }
}

/// Two are equal when their ways are, however these lie in blocks.
impl PartialEq for Odometer {
    fn eq(&self, other: &Self) -> bool {
        self.steps().eq(other.steps())
    }
}

impl Block {
    fn insert(&mut self, at: usize, step: Step) {
        self.count(step.way_um);
        self.steps.insert(at, step);
    }

    fn remove(&mut self, at: usize) {
        let step = self.steps.remove(at);
        self.discount(step.way_um);
    }

    fn set(&mut self, at: usize, way_um: Option<u64>) {
        let before = std::mem::replace(&mut self.steps[at].way_um, way_um);
        self.discount(before);
        self.count(way_um);
    }

    fn count(&mut self, way_um: Option<u64>) {
        match way_um {
            Some(way_um) => self.way_um += way_um,
            None => self.breaks += 1,
        }
    }

    fn discount(&mut self, way_um: Option<u64>) {
        match way_um {
            Some(way_um) => self.way_um -= way_um,
            None => self.breaks -= 1,
        }
    }

    fn of(steps: Vec<Step>) -> Self {
        let mut block = Self::default();
        for step in &steps {
            block.count(step.way_um);
        }
        block.steps = steps;
        block
    }
}

/// Finds a keyframe by its stamp and name, or where it belongs. There is at least one block, and no block is empty but a session's first.
pub(super) fn find(
    blocks: &[Block],
    stamp: Stamp,
    id: &KeyframeId,
    keyframes: &DenseMap<Keyframe>,
) -> Result<Place, Place> {
    let by_stamp = |step: &Step| match keyframes.get(step.keyframe.index()) {
        Some(other) => (other.stamp, &other.id).cmp(&(stamp, id)),
        None => Ordering::Less,
    };
    let starts_before =
        |block: &Block| block.steps.first().is_some_and(|first| by_stamp(first) != Ordering::Greater);
    let block = blocks.partition_point(starts_before).saturating_sub(1);
    let place = |at| Place { block, at };
    blocks[block].steps.binary_search_by(by_stamp).map(place).map_err(place)
}

/// Returns the steps before a place, the nearest first.
pub(super) fn steps_before(blocks: &[Block], place: Place) -> impl Iterator<Item = &Step> {
    let before = blocks[..place.block].iter().rev().flat_map(|block| block.steps.iter().rev());
    blocks[place.block].steps[..place.at].iter().rev().chain(before)
}

/// Returns the steps from a place on.
pub(super) fn steps_from(blocks: &[Block], place: Place) -> impl Iterator<Item = &Step> {
    let after = blocks[place.block + 1..].iter().flat_map(|block| &block.steps);
    blocks[place.block].steps[place.at..].iter().chain(after)
}

/// Measures the step to a keyframe from the one before it.
fn measure_step(blocks: &mut [Block], place: Place, measure: Measure<'_>) {
    let keyframe = blocks[place.block].steps[place.at].keyframe;
    let before = steps_before(blocks, place).next();
    let way_um = before.and_then(|before| measure(before.keyframe, keyframe));
    blocks[place.block].set(place.at, way_um);
}

/// Measures the steps to and from a keyframe.
fn measure_around(blocks: &mut [Block], place: Place, measure: Measure<'_>) {
    measure_step(blocks, place, measure);
    let is_last = place.at + 1 == blocks[place.block].steps.len();
    let after = if is_last { Place { block: place.block + 1, at: 0 } } else { place.next() };
    if after.block < blocks.len() {
        measure_step(blocks, after, measure);
    }
}

fn split(blocks: &mut Vec<Block>, at: usize) {
    if blocks[at].steps.len() > BLOCK_MAX {
        let mut first = std::mem::take(&mut blocks[at].steps);
        let second = first.split_off(first.len() / 2);
        blocks[at] = Block::of(first);
        blocks.insert(at + 1, Block::of(second));
    }
}

#[cfg(test)]
mod tests;
