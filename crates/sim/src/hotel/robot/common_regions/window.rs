//! Window: the map points around a candidate, in its camera frame.

use std::collections::BTreeSet;

use crate::geometry::Point3;
use crate::hotel::building::texture::Descriptor;
use crate::hotel::robot::slam_map::SlamMap;

/// Number of keyframes around the middle one: those that share most points with it.
pub const COVISIBLE: usize = 10;

/// A map point of a window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WindowPoint {
    /// Its position in the candidate's camera frame, in metres.
    pub in_candidate: Point3,
    /// The position of the camera that first saw it, in the same frame, in metres.
    pub first_seen_from: Point3,
    /// The octave in which that camera saw it.
    pub octave: u8,
    /// Its descriptor.
    pub descriptor: Descriptor,
}

/// Returns the candidate and the keyframes around it, in the order of their numbers.
pub fn keyframes_around(map: &SlamMap<'_>, candidate: usize) -> BTreeSet<usize> {
    map.covisible(candidate, COVISIBLE).into_iter().chain([candidate]).collect()
}

/// Returns the same. If fewer than ten are covisible with the candidate, adds up to ten keyframes for each that are
/// covisible with them but not with the query.
pub fn keyframes_farther_around(
    map: &SlamMap<'_>,
    candidate: usize,
    left_out: &BTreeSet<usize>,
) -> BTreeSet<usize> {
    let near = keyframes_around(map, candidate);
    let mut all = near.clone();
    if near.len() <= COVISIBLE {
        for keyframe in near {
            let farther = map.covisible(keyframe, COVISIBLE);
            all.extend(farther.into_iter().filter(|other| !left_out.contains(other)));
        }
    }
    all
}

/// Returns the map points seen by these keyframes, in the order of their numbers.
pub fn points_of(map: &SlamMap<'_>, keyframes: &BTreeSet<usize>, candidate: usize) -> Vec<WindowPoint> {
    let ids: BTreeSet<u64> = keyframes.iter().flat_map(|keyframe| map.point_ids(*keyframe)).collect();
    let candidate_from_map = map.pose(candidate).inverse();
    let point = |id: u64| {
        let (place, first_pose, first) = map.point(id)?;
        Some(WindowPoint {
            in_candidate: candidate_from_map.transform(&place),
            first_seen_from: candidate_from_map.transform(&first_pose.centre()),
            octave: first.keypoint.octave,
            descriptor: first.descriptor,
        })
    };
    ids.into_iter().filter_map(point).collect()
}
