//! Sensor: simulates the robot's camera, depth estimate and detector from one pose.

use super::camera::{FOCAL_LENGTH_PX, Stand, project, unproject};
use crate::domain::keyframe::Keypoint;
use crate::geometry::{Point3, Pose};
use crate::hotel::building::floor_plan::{Flat, Wall, is_hidden};
use crate::hotel::building::furnishing::WorldPoint;
use crate::hotel::building::signs::{Sign, SignKind};
use crate::hotel::building::texture::{Descriptor, from_side, in_image};
use crate::hotel::building::world::World;
use crate::hotel::rng::SeededRng;

/// Maximum range of recognition.
pub const RANGE_M: f64 = 8.0;
/// Share of the corners on which a feature detector fires.
const FOUND_SHARE: f64 = 0.85;
/// Maximum features of an image; the nearest are kept.
const FEATURES_MAX: usize = 400;
/// Maximum angle between a corner's normal and the view for recognition.
const MAX_OBLIQUITY_RAD: f64 = 1.3;
/// Width of a sector of viewing directions with the same appearance.
const SECTOR_RAD: f64 = 0.61;
/// Standard deviation of a keypoint's position at octave 0, in pixels.
const KEYPOINT_SIGMA_PX: f64 = 0.6;
/// Standard deviation of a point's depth, as a share of it.
const DEPTH_SIGMA: f64 = 0.012;
/// The octave of the image pyramid in which a corner at its reference distance is seen.
const MIDDLE_OCTAVE: f64 = 3.0;
/// The number of octaves of the pyramid.
pub const OCTAVES: f64 = 8.0;
/// The scale from one octave to the next.
pub const OCTAVE_FACTOR: f64 = 1.2;
/// Standard deviation of a keypoint's angle in an upright camera, in degrees.
const ANGLE_SIGMA_DEG: f64 = 4.0;
/// Maximum angle between a sign's normal and the view for detection.
const SIGN_MAX_OBLIQUITY_RAD: f64 = 1.25;
/// Minimum number of a sign's points among the features.
const SIGN_POINTS_MIN: usize = 3;
/// Standard deviation of a box's corners, in pixels.
const BOX_SIGMA_PX: f64 = 1.5;

/// A corner found in an image.
#[derive(Clone, Copy, Debug)]
pub struct Feature {
    /// Its point in the world, for the ground truth only.
    pub point: u32,
    /// Its position in the image.
    pub keypoint: Keypoint,
    /// Its appearance.
    pub descriptor: Descriptor,
    /// Its position by depth in the camera's frame, in metres.
    pub in_camera: Point3,
}

/// A sign found in an image.
#[derive(Clone, Debug)]
pub struct SeenSign {
    /// Its sign in the world, for the reader and the ground truth only.
    pub sign: usize,
    /// `[x0, y0, x1, y1]`, in pixels.
    pub bounding_box: [f64; 4],
    /// The detector's confidence.
    pub confidence: f64,
    /// The indices of the image's features on it.
    pub features: Vec<usize>,
}

/// One image.
#[derive(Clone, Debug)]
pub struct Image {
    /// Its corners.
    pub features: Vec<Feature>,
    /// Its signs.
    pub signs: Vec<SeenSign>,
}

/// Takes an image. `missed_share` of the signs are missed.
pub fn take_image(world: &World, stand: &Stand, missed_share: f64, rng: &mut SeededRng) -> Image {
    let walls = world.plan.walls_around(stand.at, RANGE_M);
    let view = View { at: stand.at, map_from_camera: stand.map_from_camera(), walls };
    let mut features: Vec<Feature> = (world.points.iter().enumerate())
        .filter_map(|(number, point)| view.find(number, point, rng))
        .collect();
    if features.len() > FEATURES_MAX {
        features.sort_by(|a, b| a.in_camera.z.total_cmp(&b.in_camera.z).then(a.point.cmp(&b.point)));
        features.truncate(FEATURES_MAX);
        features.sort_by_key(|feature| feature.point);
    }
    let signs = (world.signs.iter().enumerate())
        .filter_map(|(number, sign)| {
            let seen = view.detect(number, sign, &features, rng)?;
            (!rng.happens(missed_share)).then_some(seen)
        })
        .collect();
    Image { features, signs }
}

/// The place of a camera, and the walls that may hide what it looks at.
struct View {
    at: Flat,
    map_from_camera: Pose,
    walls: Vec<Wall>,
}

impl View {
    fn find(&self, number: usize, point: &WorldPoint, rng: &mut SeededRng) -> Option<Feature> {
        let [x, y, z] = point.position;
        let (dx, dy) = (self.at[0] - x, self.at[1] - y);
        if dx.hypot(dy) > RANGE_M {
            return None;
        }
        let position = Point3::from(point.position);
        let in_camera = self.map_from_camera.inverse_transform(&position);
        let [u, v] = project(&in_camera)?;
        let depth_m = in_camera.z;
        let octave = (MIDDLE_OCTAVE + (point.reference_m / depth_m).ln() / OCTAVE_FACTOR.ln()).round();
        if !(0.0..OCTAVES).contains(&octave) {
            return None;
        }
        let dz = super::camera::CAMERA_HEIGHT_M - z;
        let distance_m = (dx * dx + dy * dy + dz * dz).sqrt();
        let facing = (point.normal[0] * dx + point.normal[1] * dy + point.normal[2] * dz) / distance_m;
        if facing < MAX_OBLIQUITY_RAD.cos()
            || is_hidden(self.at, [x, y], &self.walls)
            || !rng.happens(FOUND_SHARE)
        {
            return None;
        }
        // The viewing side: around the vertical for points on walls, by compass for horizontal surfaces.
        let azimuth = if point.normal[2].abs() > 0.5 {
            dy.atan2(dx)
        } else {
            (point.normal[0] * dy - point.normal[1] * dx).atan2(point.normal[0] * dx + point.normal[1] * dy)
        };
        let sector = (azimuth / SECTOR_RAD).round() as i32;
        let sigma_px = KEYPOINT_SIGMA_PX * OCTAVE_FACTOR.powf(octave);
        let pixel = [u + rng.normal(sigma_px), v + rng.normal(sigma_px)];
        let measured_depth_m = depth_m * (1.0 + rng.normal(DEPTH_SIGMA));
        let angle_deg = (point.angle_deg + rng.normal(ANGLE_SIGMA_DEG)).rem_euclid(360.0);
        Some(Feature {
            point: number as u32,
            keypoint: Keypoint { u: pixel[0], v: pixel[1], octave: octave as u8, angle_deg: Some(angle_deg) },
            descriptor: in_image(from_side(point.descriptor, sector), rng),
            in_camera: unproject(pixel, measured_depth_m),
        })
    }

    fn detect(
        &self,
        number: usize,
        sign: &Sign,
        features: &[Feature],
        rng: &mut SeededRng,
    ) -> Option<SeenSign> {
        let [x, y, z] = sign.centre;
        let (dx, dy) = (self.at[0] - x, self.at[1] - y);
        let distance_m = dx.hypot(dy);
        let facing = (sign.normal[0] * dx + sign.normal[1] * dy) / distance_m;
        if distance_m > sign.kind.detected_within_m() || facing < SIGN_MAX_OBLIQUITY_RAD.cos() {
            return None;
        }
        let along = [-sign.normal[1], sign.normal[0]];
        let mut bounds = [f64::INFINITY, f64::INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY];
        for (s, t) in [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)] {
            let s = s * sign.half_size_m[0];
            let corner = Point3::new(x + s * along[0], y + s * along[1], z + t * sign.half_size_m[1]);
            // A sign cut off by the image's edge is not read.
            let [u, v] = project(&self.map_from_camera.inverse_transform(&corner))?;
            bounds = [bounds[0].min(u), bounds[1].min(v), bounds[2].max(u), bounds[3].max(v)];
        }
        if is_hidden(self.at, [x, y], &self.walls) {
            return None;
        }
        let on_it: Vec<usize> = (features.iter().enumerate())
            .filter(|(_, feature)| sign.points.contains(&(feature.point as usize)))
            .map(|(place, _)| place)
            .collect();
        if on_it.len() < SIGN_POINTS_MIN {
            return None;
        }
        let bounding_box = bounds.map(|pixel| pixel + rng.normal(BOX_SIGMA_PX));
        let tall_px = 2.0 * sign.half_size_m[1] * FOCAL_LENGTH_PX / distance_m;
        let clear = if sign.kind == SignKind::Painting { 60.0 } else { 25.0 };
        let confidence = (0.55 + 0.4 * facing * (tall_px / clear).min(1.0)).clamp(0.3, 0.98);
        let ordered = [
            bounding_box[0].min(bounding_box[2]),
            bounding_box[1].min(bounding_box[3]),
            bounding_box[0].max(bounding_box[2]),
            bounding_box[1].max(bounding_box[3]),
        ];
        Some(SeenSign { sign: number, bounding_box: ordered, confidence, features: on_it })
    }
}
