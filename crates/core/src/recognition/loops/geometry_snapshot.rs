//! A keyframe and its surroundings as geometry needs them, taken from the index at one version.
//!
//! Features lie on disk and are read after the map's lock is released; poses and point positions may move
//! meanwhile. A sight keeps them as they were, so that a verdict speaks of one version of the map.

use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;

use super::features::MatchableFeatures;
use super::points_now::PointsNow;
use crate::domain::ids::{KeyframeSeq, PointId, SessionSeq};
use crate::domain::keyframe::{Camera, NewKeyframe};
use crate::geometry::{Point3, Pose};
use crate::recognition::map::index::MapIndex;
use crate::recognition::verification::Landmark;

/// Keyframes covisible with a candidate whose points join the guided search, those that share most
/// first. ORB-SLAM3 takes ten as well.
pub(in crate::recognition) const WINDOW_KEYFRAMES: usize = 10;

/// A keyframe as geometry sees it.
#[derive(Clone, Debug)]
pub struct GeometrySnapshot {
    /// Its camera.
    pub camera: Camera,
    /// The session whose numbers its map points have; none if the map does not know it.
    session: Option<SessionSeq>,
    pub(in crate::recognition) session_from_camera: Pose,
    positions_in_session: HashMap<PointId, Point3>,
    /// The covisible keyframes of its session whose points join the guided search, those that share most first.
    pub window: Vec<KeyframeSeq>,
    /// Of the keyframe and its window, those whose map points are others than their features were sent with.
    pub(in crate::recognition) points_now: BTreeMap<KeyframeSeq, Arc<PointsNow>>,
}

impl GeometrySnapshot {
    /// Of a keyframe of the map, with its window; `None` if its client did not tell the camera.
    pub fn stored(index: &MapIndex, seq: KeyframeSeq) -> Option<Self> {
        let keyframe = index.keyframe(seq)?;
        let mut sight = Self {
            camera: keyframe.camera?,
            session: Some(keyframe.session),
            session_from_camera: keyframe.map_from_camera,
            positions_in_session: HashMap::new(),
            window: window(index, seq, keyframe.session),
            points_now: BTreeMap::new(),
        };
        sight.points_now.extend(PointsNow::of(keyframe).map(|points| (seq, points)));
        sight.learn(index, keyframe.session, keyframe.observes.iter());
        for neighbour in sight.window.clone() {
            if let Some(neighbour) = index.keyframe(neighbour) {
                sight.points_now.extend(PointsNow::of(neighbour).map(|points| (neighbour.seq, points)));
                sight.learn(index, keyframe.session, neighbour.observes.iter());
            }
        }
        Some(sight)
    }

    /// Of a keyframe that is not stored; `session` is the one whose frame and numbers it has, if the map knows it.
    pub fn inline(index: &MapIndex, session: Option<SessionSeq>, keyframe: &NewKeyframe) -> Option<Self> {
        let mut sight = Self {
            camera: keyframe.camera?,
            session,
            session_from_camera: keyframe.map_from_camera,
            positions_in_session: HashMap::new(),
            window: Vec::new(),
            points_now: BTreeMap::new(),
        };
        if let Some(session) = session {
            sight.learn(index, session, keyframe.observes.iter().copied());
        }
        sight.positions_in_session.extend(keyframe.map_points.iter().copied());
        Some(sight)
    }

    fn learn(&mut self, index: &MapIndex, session: SessionSeq, ids: impl Iterator<Item = PointId>) {
        let placed = ids.filter_map(|id| Some((id, index.points().position(session, id)?)));
        self.positions_in_session.extend(placed);
    }

    /// Returns the map point of each feature in this keyframe's camera frame, in metres.
    pub fn points_in_camera(&self, features: &MatchableFeatures) -> Vec<Option<Point3>> {
        features.map_points.iter().map(|id| self.point_in_camera((*id)?)).collect()
    }

    /// Returns where a map point is in the session's frame, if this keyframe or its window observes it.
    pub(in crate::recognition) fn position(&self, id: PointId) -> Option<&Point3> {
        self.positions_in_session.get(&id)
    }

    fn point_in_camera(&self, id: PointId) -> Option<Point3> {
        Some(self.session_from_camera.inverse_transform(self.position(id)?))
    }

    /// Returns the points that the window's keyframes see and this one does not, each with every descriptor it was seen
    /// by. They are numbered in the order of their ids. A point that the query sees under the same number is left out,
    /// too: that it matches says what is known already.
    pub fn landmarks<'a>(
        &self,
        own: &MatchableFeatures,
        window: impl Iterator<Item = &'a MatchableFeatures>,
        query: (&Self, &MatchableFeatures),
    ) -> Vec<Landmark<'a>> {
        let mut seen: BTreeMap<PointId, Vec<&'a [u64]>> = BTreeMap::new();
        for features in window {
            for (feature, id) in features.map_points.iter().enumerate() {
                if let Some(id) = id {
                    seen.entry(*id).or_default().push(features.descriptors.get(feature));
                }
            }
        }
        let known = if query.0.session == self.session { &query.1.map_points[..] } else { &[] };
        for id in own.map_points.iter().chain(known).flatten() {
            seen.remove(id);
        }
        let mut landmarks = Vec::new();
        for (number, (id, descriptors)) in seen.into_iter().enumerate() {
            let Some(point_in_camera) = self.point_in_camera(id) else { continue };
            let landmark = |descriptor| Landmark { id: number as u64, point_in_camera, descriptor };
            landmarks.extend(descriptors.into_iter().map(landmark));
        }
        landmarks
    }
}

fn window(index: &MapIndex, seq: KeyframeSeq, session: SessionSeq) -> Vec<KeyframeSeq> {
    let of_session = |(other, _): &(KeyframeSeq, u32)| index.session_of(*other) == Some(session);
    let mut neighbours: Vec<(KeyframeSeq, u32)> =
        index.covisibility().shared(seq).filter(of_session).collect();
    neighbours.sort_by_key(|(other, shared)| (std::cmp::Reverse(*shared), *other));
    neighbours.into_iter().take(WINDOW_KEYFRAMES).map(|(other, _)| other).collect()
}
