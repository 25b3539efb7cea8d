//! The way of a session, asked of the map (M15).

use super::map_index::MapIndex;
use super::odometer::{Measure, Milestone, Odometer, UM_PER_M, before, find, step_after};
use crate::domain::change::Keyframe;
use crate::domain::ids::KeyframeSeq;
use crate::geometry::Point3;
use crate::recognition::map::dense_map::DenseMap;

/// The longest step that is counted, in metres: a million keyframes of it fit a `u64` of micrometres.
const STEP_MAX_M: f64 = 1e6;

impl MapIndex {
    /// Returns where a keyframe stands on its session's way.
    pub fn milestone(&self, keyframe: KeyframeSeq) -> Option<Milestone> {
        self.odometer.milestone(self.keyframe(keyframe)?, &self.keyframes)
    }

    /// Returns the keyframes back from one on its session's way, that one first.
    pub fn way_back(&self, from: KeyframeSeq) -> impl Iterator<Item = KeyframeSeq> {
        let place = self.keyframe(from).and_then(|keyframe| {
            let blocks = self.odometer.sessions.get(&keyframe.session)?;
            Some((blocks, find(blocks, keyframe.stamp, &keyframe.id, &self.keyframes).ok()?))
        });
        let steps = place.into_iter().flat_map(|(blocks, place)| {
            let (before, rest) = blocks.split_at(place.block);
            let own = rest.iter().take(1).flat_map(move |block| &block.steps[..=place.at]).rev();
            own.chain(before.iter().rev().flat_map(|block| block.steps.iter().rev()))
        });
        steps.map(|step| step.keyframe)
    }

    /// Returns the keyframes on from one on its session's way, that one first.
    pub fn way_on(&self, from: KeyframeSeq) -> impl Iterator<Item = KeyframeSeq> {
        let place = self.keyframe(from).and_then(|keyframe| {
            let blocks = self.odometer.sessions.get(&keyframe.session)?;
            Some((blocks, find(blocks, keyframe.stamp, &keyframe.id, &self.keyframes).ok()?))
        });
        let steps = place.into_iter().flat_map(|(blocks, place)| {
            let rest = &blocks[place.block..];
            let own = rest.iter().take(1).flat_map(move |block| &block.steps[place.at..]);
            own.chain(rest.iter().skip(1).flat_map(|block| &block.steps))
        });
        steps.map(|step| step.keyframe)
    }

    /// Returns the keyframes before and after one on its session's way, each with the length of the step between, in
    /// micrometres; none where the way is broken.
    pub fn steps_of(&self, keyframe: KeyframeSeq) -> impl Iterator<Item = (KeyframeSeq, u64)> {
        let steps = self.keyframe(keyframe).and_then(|keyframe| {
            let blocks = self.odometer.sessions.get(&keyframe.session)?;
            let place = find(blocks, keyframe.stamp, &keyframe.id, &self.keyframes).ok()?;
            let own = blocks[place.block].steps.get(place.at)?;
            let to_own = before(blocks, place).zip(own.way_um);
            let next = step_after(blocks, place).and_then(|step| Some((step.keyframe, step.way_um?)));
            Some([to_own, next])
        });
        steps.into_iter().flatten().flatten()
    }

    /// Whether no keyframe comes after this one on its session's way.
    pub fn is_last_on_way(&self, keyframe: KeyframeSeq) -> bool {
        let stored = self.keyframe(keyframe);
        let blocks = stored.and_then(|keyframe| self.odometer.sessions.get(&keyframe.session));
        let last = blocks.and_then(|blocks| blocks.last()?.steps.last());
        last.is_some_and(|step| step.keyframe == keyframe)
    }

    /// Adds a keyframe to its session's way; its neighbours by shared points are known already.
    pub(super) fn track(&mut self, keyframe: KeyframeSeq) {
        self.odometer_with(keyframe, Odometer::add);
        self.count_unlinked(keyframe, true);
    }

    /// Takes a keyframe from its session's way, before it leaves the map.
    pub(super) fn untrack(&mut self, keyframe: KeyframeSeq) {
        self.odometer_with(keyframe, Odometer::remove);
        self.count_unlinked(keyframe, false);
    }

    /// Measures the steps from and to a keyframe again, after its pose changed.
    pub(super) fn retrack(&mut self, keyframe: KeyframeSeq) {
        self.odometer_with(keyframe, Odometer::moved);
    }

    /// Measures every step again, after it changed which keyframes share enough points.
    pub(super) fn retrack_all(&mut self) {
        self.odometer = Odometer::default();
        self.unlinked.clear();
        let keyframes: Vec<KeyframeSeq> = self.keyframes.values().map(|keyframe| keyframe.seq).collect();
        for keyframe in keyframes {
            self.track(keyframe);
        }
    }

    fn odometer_with(
        &mut self,
        keyframe: KeyframeSeq,
        change: impl FnOnce(&mut Odometer, &Keyframe, &DenseMap<Keyframe>, Measure<'_>),
    ) {
        let mut odometer = std::mem::take(&mut self.odometer);
        if let Some(keyframe) = self.keyframe(keyframe) {
            change(&mut odometer, keyframe, &self.keyframes, &|from, to| self.step_um(from, to));
        }
        self.odometer = odometer;
    }

    fn step_um(&self, from: KeyframeSeq, to: KeyframeSeq) -> Option<u64> {
        if !self.covisibility().joins_by_points(from, to) {
            return None;
        }
        let centre = |seq| Some(self.keyframe(seq)?.map_from_camera.centre());
        Some(step_length_um(centre(from)?, centre(to)?))
    }
}

/// Returns the length of a step between two places, in micrometres.
pub(super) fn step_length_um(from: Point3, to: Point3) -> u64 {
    ((to - from).norm().min(STEP_MAX_M) * UM_PER_M).round() as u64
}
