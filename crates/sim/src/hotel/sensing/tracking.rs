//! Tracking: the map point of a feature, as the robot's own SLAM numbers it.

use std::collections::HashMap;

/// Keyframes without a sight of a point after which it is no longer tracked. It then gets a new number, so that a
/// revisit is not covisible with the earlier visit.
const FORGOTTEN_AFTER_KEYFRAMES: usize = 100;

/// The map points of one robot.
#[derive(Clone, Debug, Default)]
pub struct Tracker {
    points: HashMap<u32, Tracked>,
    next: u64,
}

#[derive(Clone, Copy, Debug)]
struct Tracked {
    id: u64,
    last_seen: usize,
}

impl Tracker {
    /// Returns the map point's number in this keyframe, and whether it is new.
    pub fn observe(&mut self, point: u32, keyframe: usize) -> (u64, bool) {
        if let Some(tracked) = self.points.get_mut(&point)
            && keyframe - tracked.last_seen <= FORGOTTEN_AFTER_KEYFRAMES
        {
            tracked.last_seen = keyframe;
            return (tracked.id, false);
        }
        let id = self.next;
        self.next += 1;
        self.points.insert(point, Tracked { id, last_seen: keyframe });
        (id, true)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_keeps_its_number_while_it_is_tracked() {
        let mut tracker = Tracker::default();
        assert_eq!(tracker.observe(7, 0), (0, true));
        assert_eq!(tracker.observe(8, 0), (1, true));
        assert_eq!(tracker.observe(7, 100), (0, false));
        assert_eq!(tracker.observe(8, 101), (2, true));
    }
}
