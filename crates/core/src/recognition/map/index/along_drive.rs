//! Neighbours along the drive: what stands in for the covisibility that a client does not know (M62).
//!
//! A keyframe without map points and without a list of covisible keyframes is *unlinked*. It is covisible with the keyframes of
//! its session, before and after it by stamp, to which the robot drove no farther, and took no longer, than the settings say.
//! A keyframe with a list keeps to it: an empty one says that nothing is covisible.
//!
//! The neighbours follow from stamps and poses, and are not kept. Lengths are whole micrometres, so that the way is the same
//! from either end.

use super::map_index::MapIndex;
use super::odometer::{Step, UM_PER_M, find, steps_before, steps_from};
use super::way::step_length_um;
use crate::domain::change::Keyframe;
use crate::domain::ids::{KeyframeId, KeyframeSeq, SessionSeq};
use crate::domain::keyframe::{NewKeyframe, Stamp};
use crate::geometry::Point3;

/// The most neighbours on either side: what is asked of a keyframe costs no more where a client sends each frame.
const NEIGHBOURS_MAX: usize = 64;
/// Neighbours were taken no longer before or after a keyframe, by their clock, in seconds.
pub(in crate::recognition) const MAX_GAP_S: f64 = 20.0;

/// The covisibility that a client told of a keyframe.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Links {
    /// A list.
    Listed,
    /// Map points: covisible is what shares enough of them.
    Points,
    /// Nothing.
    Unlinked,
}

impl Links {
    fn of(has_list: bool, has_points: bool) -> Self {
        match (has_list, has_points) {
            (true, _) => Self::Listed,
            (false, true) => Self::Points,
            (false, false) => Self::Unlinked,
        }
    }

    fn of_stored(keyframe: &Keyframe) -> Self {
        Self::of(keyframe.declared.is_some(), !keyframe.observes.is_empty())
    }

    fn joins(self, other: Self) -> bool {
        let is_listed = self == Self::Listed || other == Self::Listed;
        !is_listed && (self == Self::Unlinked || other == Self::Unlinked)
    }
}

/// A keyframe on the way of its session.
struct OnTheWay<'a> {
    session: SessionSeq,
    stamp: Stamp,
    id: &'a KeyframeId,
    centre: Point3,
    links: Links,
}

impl MapIndex {
    /// Returns the neighbours of a keyframe along the drive, ascending.
    pub(super) fn along_drive(&self, keyframe: KeyframeSeq) -> Vec<KeyframeSeq> {
        let Some(stored) = self.keyframe(keyframe) else { return Vec::new() };
        self.neighbours_of(&OnTheWay {
            session: stored.session,
            stamp: stored.stamp,
            id: &stored.id,
            centre: stored.map_from_camera.centre(),
            links: Links::of_stored(stored),
        })
    }

    /// Returns the neighbours along the drive that a keyframe of a session of the map would have, ascending.
    pub fn along_drive_of(&self, session: SessionSeq, keyframe: &NewKeyframe) -> Vec<KeyframeSeq> {
        self.neighbours_of(&OnTheWay {
            session,
            stamp: keyframe.stamp,
            id: &keyframe.id,
            centre: keyframe.map_from_camera.centre(),
            links: Links::of(keyframe.covisible.is_some(), !keyframe.observes.is_empty()),
        })
    }

    /// Whether two keyframes are neighbours along the drive.
    pub(super) fn joins_along_drive(&self, a: KeyframeSeq, b: KeyframeSeq) -> bool {
        let Some((of_a, of_b)) = self.keyframe(a).zip(self.keyframe(b)) else { return false };
        let may_join = of_a.session == of_b.session
            && Links::of_stored(of_a).joins(Links::of_stored(of_b))
            && of_a.stamp.gap_s(of_b.stamp) <= MAX_GAP_S;
        may_join && self.is_near_along_drive(of_a, of_b)
    }

    /// Whether two keyframes of a session are near each other on its way: from the earlier to the later one, as the way is the same
    /// from either end.
    fn is_near_along_drive(&self, a: &Keyframe, b: &Keyframe) -> bool {
        let (first, last) = if (a.stamp, &a.id) <= (b.stamp, &b.id) { (a, b) } else { (b, a) };
        let most_m = self.properties.settings.covisibility_max_way_m;
        let most_um = (most_m * UM_PER_M).round() as u64;
        let (mut way_um, mut at) = (0_u64, first.map_from_camera.centre());
        for seq in self.way_on(first.seq).skip(1).take(NEIGHBOURS_MAX) {
            let Some(next) = self.keyframe(seq) else { return false };
            let centre = next.map_from_camera.centre();
            way_um = way_um.saturating_add(step_length_um(at, centre));
            at = centre;
            if way_um > most_um {
                return false;
            }
            if seq == last.seq {
                return most_m > 0.0;
            }
        }
        false
    }

    fn neighbours_of(&self, own: &OnTheWay<'_>) -> Vec<KeyframeSeq> {
        let most_m = self.properties.settings.covisibility_max_way_m;
        // Nearly every session has map points, and is not searched.
        let has_any = own.links == Links::Unlinked || self.unlinked.contains_key(&own.session);
        let blocks = self.odometer.sessions.get(&own.session);
        let Some(blocks) = blocks.filter(|_| own.links != Links::Listed && has_any && most_m > 0.0) else {
            return Vec::new();
        };
        let (place, next) = match find(blocks, own.stamp, own.id, &self.keyframes) {
            Ok(place) => (place, place.next()),
            Err(place) => (place, place),
        };
        let mut near = self.within(own, steps_before(blocks, place));
        near.extend(self.within(own, steps_from(blocks, next)));
        near.sort_unstable();
        near
    }

    /// Returns those of the keyframes on the way from one, nearest first, that are its neighbours.
    fn within<'a>(&self, own: &OnTheWay<'_>, steps: impl Iterator<Item = &'a Step>) -> Vec<KeyframeSeq> {
        let settings = &self.properties.settings;
        let most_um = (settings.covisibility_max_way_m * UM_PER_M).round() as u64;
        let (mut way_um, mut at) = (0_u64, own.centre);
        let reached = steps.take(NEIGHBOURS_MAX).map_while(|step| {
            let other = self.keyframe(step.keyframe)?;
            let centre = other.map_from_camera.centre();
            way_um = way_um.saturating_add(step_length_um(at, centre));
            at = centre;
            let is_near = way_um <= most_um && own.stamp.gap_s(other.stamp) <= MAX_GAP_S;
            is_near.then_some(other)
        });
        reached.filter(|other| own.links.joins(Links::of_stored(other))).map(|other| other.seq).collect()
    }

    /// Counts a keyframe among those of its session that are unlinked, or takes it from them.
    pub(super) fn count_unlinked(&mut self, keyframe: KeyframeSeq, is_there: bool) {
        let Some(stored) = self.keyframe(keyframe) else { return };
        if Links::of_stored(stored) != Links::Unlinked {
            return;
        }
        let session = stored.session;
        let count = self.unlinked.entry(session).or_default();
        *count = if is_there { *count + 1 } else { count.saturating_sub(1) };
        if *count == 0 {
            self.unlinked.remove(&session);
        }
    }
}
