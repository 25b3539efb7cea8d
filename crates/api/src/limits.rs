//! Limits: how much of everything one request may bring.
//!
//! Each is far above what a robot sends and far below what would hurt the server. These are of what is decoded by hand; they stand in
//! the API document too, and a test compares the two. The others stand with the member that they bound.

use std::ops::RangeInclusive;

/// The most bytes of a body, compressed and inflated alike.
pub const BODY_BYTES: usize = 32 << 20;
/// The most bytes of one line of a bulk request.
pub const LINE_BYTES: usize = 8 << 20;
/// The most bytes of a whole bulk request, inflated.
pub const BULK_BYTES: usize = 1 << 30;
/// The most lines of a bulk request.
pub const BULK_ITEMS: usize = 100_000;
/// The most values of a JSON body, counted over all its levels: a body of `0,0,0,...` takes many times its size in memory.
/// The largest correction of poses has 1.6 million.
pub const BODY_VALUES: usize = 2_000_000;
/// The most items of any list; what a list of a kind may hold is less, and told with its name.
pub const LIST_ITEMS: usize = 200_000;
/// Size that a compressed body may have in memory, however small it came: as text, and as the values in it.
pub const INFLATED_FREE_BYTES: usize = 2 << 20;
/// And so many bytes more for each byte that came. Robots' keyframes are a tenth of their size when compressed; a bomb is
/// a thousandth.
pub const INFLATED_FOLD: usize = 64;
/// The most faults of one body that are listed.
pub const LISTED_FAULTS: usize = 100;

/// Coordinates, in metres: to the Sun is farther, no building is.
pub const COORDINATE_M: RangeInclusive<f64> = -1e9..=1e9;
/// Image coordinates, focal lengths and box corners, in pixels; they may lie outside the image.
pub const PIXEL: RangeInclusive<f64> = -1e6..=1e6;
/// One number of a quaternion.
pub const QUATERNION: RangeInclusive<f64> = -1.01..=1.01;
/// One number of a unit vector.
pub const DIRECTION: RangeInclusive<f64> = -1.001..=1.001;
/// A keypoint's orientation, in degrees; whether a detector counts to 360 or from -180 is its own affair.
pub const ANGLE_DEG: RangeInclusive<f64> = -360.0..=360.0;
/// A level of the image pyramid.
pub const OCTAVE: RangeInclusive<i64> = 0..=63;

/// Bytes of one descriptor, a multiple of 8.
pub const DESCRIPTOR_BYTES: RangeInclusive<i64> = 8..=512;
/// Map points of one keyframe, observed, new or moved.
pub const MAP_POINTS: usize = 100_000;
/// A map point's number; ORB-SLAM counts in `unsigned long`, of which nobody has used the upper half.
pub const POINT: RangeInclusive<i64> = 0..=i64::MAX;
/// Covisible keyframes that one keyframe declares.
pub const COVISIBLE: usize = 10_000;
/// Detections of one keyframe.
pub const DETECTIONS: usize = 500;
/// The number of a detection in its keyframe.
pub const DETECTION: RangeInclusive<i64> = 0..=DETECTIONS as i64 - 1;
/// Characters of the name of a model, as the source of a verdict.
pub const SOURCE_CHARS: usize = 128;
/// A level of §IV-A.2.
pub const LEVEL: RangeInclusive<i64> = 1..=5;
/// Characters of a class.
pub const CLASS_CHARS: usize = 64;
/// Characters of a text, a description or a search.
pub const TEXT_CHARS: usize = 4096;

/// Bytes of a crop, decoded.
pub const CROP_BYTES: usize = 4 << 20;

/// Regular expressions of one list.
pub const PATTERNS: usize = 16;
/// Characters of a regular expression.
pub const PATTERN_CHARS: usize = 256;
/// Classes of one list that a map may name.
pub const CLASSES: usize = 256;
/// Keyframes, and map points, of one correction of poses.
pub const CORRECTIONS: usize = 100_000;
/// Map points that one request may fuse, and that it may cull.
pub const FUSED_POINTS: usize = 10_000;
/// Keyframes of which one request may say what they observe.
pub const CHANGED_KEYFRAMES: usize = 1_000;
