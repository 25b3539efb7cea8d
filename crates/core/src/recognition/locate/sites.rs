//! Sites: the keyframes of a map that stand for places, and which of them show one place.

use std::collections::{BTreeMap, BTreeSet};

use super::look_for::nearby_signs;
use crate::domain::ids::{KeyframeId, KeyframeSeq, SessionId, SessionSeq};
use crate::domain::look_for::NearbySign;
use crate::geometry::Pose;
use crate::recognition::extensions::distinctiveness::PlaceCounts;
use crate::recognition::map::index::MapIndex;

/// A keyframe of the map that stands for a place.
#[derive(Clone, Debug)]
pub struct Site {
    /// The keyframe.
    pub keyframe: KeyframeSeq,
    /// Its name.
    pub id: KeyframeId,
    /// Its session.
    pub session: SessionSeq,
    /// The session's name.
    pub session_id: SessionId,
    /// Its pose in its session's frame, in metres.
    pub map_from_camera: Pose,
    /// The signs near it that bear an identifier and hang in one place only, nearest first.
    pub signs: Vec<NearbySign>,
}

/// The sites of a search, each keyframe once.
pub(super) struct Sites<'a> {
    index: &'a MapIndex,
    /// Them, by number.
    pub found: Vec<Site>,
    by_keyframe: BTreeMap<KeyframeSeq, usize>,
}

impl<'a> Sites<'a> {
    /// Returns no sites of a map yet.
    pub fn new(index: &'a MapIndex) -> Self {
        Self { index, found: Vec::new(), by_keyframe: BTreeMap::new() }
    }

    /// Returns the number of a keyframe's site; none if there is no such keyframe.
    pub fn of(&mut self, keyframe: KeyframeSeq, counts: &mut PlaceCounts) -> Option<usize> {
        if let Some(known) = self.by_keyframe.get(&keyframe) {
            return Some(*known);
        }
        let stored = self.index.keyframe(keyframe)?;
        self.found.push(Site {
            keyframe,
            id: stored.id.clone(),
            session: stored.session,
            session_id: self.index.sessions()[stored.session.index()].clone(),
            map_from_camera: stored.map_from_camera,
            signs: nearby_signs(self.index, keyframe, counts),
        });
        self.by_keyframe.insert(keyframe, self.found.len() - 1);
        Some(self.found.len() - 1)
    }

    /// Returns the pairs of sites that show one place: covisible, or with a common covisible keyframe, or near each other in
    /// one session's frame.
    pub fn beside(&self) -> BTreeSet<(usize, usize)> {
        let around: Vec<BTreeSet<KeyframeSeq>> = (self.found.iter())
            .map(|site| self.index.covisibility().with_itself(site.keyframe).collect())
            .collect();
        let mut beside = BTreeSet::new();
        for a in 0..self.found.len() {
            for b in a + 1..self.found.len() {
                let are_near = self.index.are_near(self.found[a].keyframe, self.found[b].keyframe);
                if are_near || !around[a].is_disjoint(&around[b]) {
                    beside.insert((a, b));
                }
            }
        }
        beside
    }
}
