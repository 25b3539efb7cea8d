//! The way of a session, asked of the map (M15).

use super::map_index::MapIndex;
use super::odometer::{Block, Measure, Milestone, Odometer, Place, UM_PER_M, steps_before, steps_from};
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
        let place = self.place_on_way(from).into_iter();
        place.flat_map(|(blocks, place)| steps_before(blocks, place.next())).map(|step| step.keyframe)
    }

    /// Returns the keyframes on from one on its session's way, that one first.
    pub fn way_on(&self, from: KeyframeSeq) -> impl Iterator<Item = KeyframeSeq> {
        let place = self.place_on_way(from).into_iter();
        place.flat_map(|(blocks, place)| steps_from(blocks, place)).map(|step| step.keyframe)
    }

    /// Returns the keyframes before and after one on its session's way, each with the length of the step between, in
    /// micrometres; none where the way is broken.
    pub fn steps_of(&self, keyframe: KeyframeSeq) -> impl Iterator<Item = (KeyframeSeq, u64)> {
        let steps = self.place_on_way(keyframe).and_then(|(blocks, place)| {
            let mut on = steps_from(blocks, place);
            let before = steps_before(blocks, place).next().map(|step| step.keyframe);
            let to_own = before.zip(on.next()?.way_um);
            let next = on.next().and_then(|step| Some((step.keyframe, step.way_um?)));
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

    fn place_on_way(&self, keyframe: KeyframeSeq) -> Option<(&[Block], Place)> {
        self.odometer.place(self.keyframe(keyframe)?, &self.keyframes)
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
