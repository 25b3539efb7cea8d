//! Expectation: a camera should see a sign that it has in its image from where, or nearer than where, the sign was read.

use std::cmp::Reverse;

use super::readings::is_alike;
use crate::domain::anchor::AnchorState;
use crate::domain::change::Keyframe;
use crate::domain::ids::{AnchorSeq, KeyframeSeq, SessionSeq};
use crate::domain::keyframe::Camera;
use crate::geometry::pinhole::Pinhole;
use crate::geometry::{Point3, Pose};
use crate::recognition::map::index::{MapIndex, MergedAnchor};

/// A camera sees a sign from the same side up to this angle between the two directions, in radians (30 degrees).
pub const SAME_SIDE_RAD: f64 = std::f64::consts::PI / 6.0;
/// A camera would surely read a sign up to this angle, in radians (15 degrees): farther from the side it may not.
pub const CLEAR_SIDE_RAD: f64 = std::f64::consts::PI / 12.0;
/// And if the sign's centre is farther from the edge of the image than this share of its width or height: what the edge cuts
/// off is not read.
pub const CLEAR_MARGIN_SHARE: f64 = 0.1;
/// Views whose directions differ by less, in radians, show a sign alike.
pub const SAME_VIEW_RAD: f64 = 0.1;
/// The views of a sign that are looked at, the newest.
pub const VIEWS_MAX: usize = 64;

/// A sign of a session, with the views from which it was read as it is called.
#[derive(Clone, Debug)]
pub struct Sign {
    /// Its name: the oldest anchor.
    pub root: AnchorSeq,
    /// The session in whose frame it stands here.
    pub session: SessionSeq,
    /// Its centre in that frame, in metres.
    pub centre: Point3,
    /// The newest keyframes of the session that read it, with the place of each camera.
    views: Vec<(KeyframeSeq, Point3)>,
}

/// A keyframe that should see a sign.
#[derive(Clone, Copy, Debug)]
pub struct Expecting {
    /// The keyframe.
    pub keyframe: KeyframeSeq,
    /// The one that read the sign from the nearest direction.
    pub read_by: KeyframeSeq,
    /// The angle between the two directions, in radians.
    pub angle_rad: f64,
    /// Whether nothing in the view may keep a reader from reading it.
    pub is_clear: bool,
}

impl Sign {
    /// Returns a sign of a session, if it is one that readers read, and something measured where it stands.
    pub fn of(index: &MapIndex, session: SessionSeq, root: AnchorSeq) -> Option<Self> {
        let object = index.objects().get(root)?;
        let centre = centre_of(object, session)?;
        let mut views = Vec::new();
        for anchor in index.anchors_of(object) {
            let newest = anchor.observations.values().rev().filter_map(|seen| {
                let keyframe = index.keyframe(seen.keyframe)?;
                let reads = keyframe.session == session && is_alike(object, seen);
                reads.then(|| (seen.keyframe, keyframe.map_from_camera.centre()))
            });
            views.extend(newest.take(VIEWS_MAX));
        }
        views.sort_by_key(|(keyframe, _)| Reverse(*keyframe));
        views.truncate(VIEWS_MAX);
        (!views.is_empty()).then_some(Self { root, session, centre, views })
    }

    /// Returns how a keyframe should see the sign, if it should.
    pub fn expected_by(&self, keyframe: &Keyframe) -> Option<Expecting> {
        let camera = keyframe.camera.as_ref()?;
        let pixel = pixel(&self.centre, camera, &keyframe.map_from_camera)?;
        if !is_within(pixel, camera, 0.0) {
            return None;
        }
        let towards = |place: &Point3| place - self.centre;
        let own = towards(&keyframe.map_from_camera.centre());
        let alike = self.views.iter().filter_map(|(read_by, place)| {
            let other = towards(place);
            let angle_rad = libm::atan2(own.cross(&other).norm(), own.dot(&other));
            (own.norm() <= other.norm() && angle_rad <= SAME_SIDE_RAD).then_some((*read_by, angle_rad))
        });
        // Of views that differ little the newest: odometry has drifted least since.
        let rank = |(read_by, angle_rad): &(KeyframeSeq, f64)| {
            ((angle_rad / SAME_VIEW_RAD).floor() as u32, Reverse(*read_by))
        };
        let (read_by, angle_rad) = alike.min_by_key(rank)?;
        let is_clear = angle_rad <= CLEAR_SIDE_RAD && is_within(pixel, camera, CLEAR_MARGIN_SHARE);
        Some(Expecting { keyframe: keyframe.seq, read_by, angle_rad, is_clear })
    }
}

/// Returns an object's centre in a session's frame, if its passages may be judged: a description by hand knows better, and a
/// distance that nothing measured says nothing of what should be in view.
pub(super) fn centre_of(object: &MergedAnchor, session: SessionSeq) -> Option<Point3> {
    let is_read = object.description.as_ref().is_some_and(|description| !description.by_hand);
    let takes_part = matches!(object.state, AnchorState::Valid | AnchorState::Retired);
    let shape = object.shapes.get(&session).filter(|shape| is_read && takes_part && !shape.range_assumed)?;
    Some(shape.aabb?.centre())
}

/// Whether a point of the session's frame is in a keyframe's image.
pub(super) fn is_in_image(point: &Point3, camera: &Camera, map_from_camera: &Pose) -> bool {
    pixel(point, camera, map_from_camera).is_some_and(|pixel| is_within(pixel, camera, 0.0))
}

fn pixel(point: &Point3, camera: &Camera, map_from_camera: &Pose) -> Option<[f64; 2]> {
    let Camera { fx, fy, cx, cy, .. } = *camera;
    Pinhole { fx, fy, cx, cy }.project(&map_from_camera.inverse_transform(point).coords)
}

/// Whether a pixel is in the image, and off its edges by a share of its width and height.
fn is_within([u, v]: [f64; 2], camera: &Camera, margin_share: f64) -> bool {
    let inside = |at: f64, size: u32| {
        let size = f64::from(size);
        (margin_share * size..=(1.0 - margin_share) * size).contains(&at)
    };
    inside(u, camera.width) && inside(v, camera.height)
}
