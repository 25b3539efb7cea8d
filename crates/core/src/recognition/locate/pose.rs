//! The uncertainty of a pose.

use nalgebra::Vector3;

use crate::domain::location::{Assumption, Uncertainty};
use crate::geometry::{Point3, Pose};

/// The standard deviation of an anchor's position as a camera measures it: a fixed part, in metres, and a share of its
/// distance.
pub(in crate::recognition) const SIGHTING_SIGMA_M: f64 = 0.3;
/// The share of the distance.
pub(in crate::recognition) const SIGHTING_SIGMA_SHARE: f64 = 0.03;
/// The standard deviation of a camera's tilt against the vertical that is assumed, in radians.
pub(in crate::recognition) const ASSUMED_TILT_SIGMA_RAD: f64 = 0.1;
/// The standard deviation of a vertical that an accelerometer told, in radians.
pub(in crate::recognition) const MEASURED_TILT_SIGMA_RAD: f64 = 0.01;

/// Returns the standard deviation of a sighted position, in metres: the camera's own, and the map's.
pub fn sighting_sigma_m(centre_in_camera: &Point3) -> f64 {
    let own = SIGHTING_SIGMA_M + SIGHTING_SIGMA_SHARE * centre_in_camera.coords.norm();
    libm::hypot(own, SIGHTING_SIGMA_M)
}

/// Returns the standard deviations of `map_from_camera` from these pairs of positions in the camera and in the map, all in
/// metres. Where the residuals are larger than the sightings' noise, they count.
pub fn uncertainty(
    pairs: &[(Point3, Point3)],
    map_from_camera: &Pose,
    assumed: &[Assumption],
    has_free_rotation: bool,
) -> Uncertainty {
    let count = pairs.len() as f64;
    let of_noise = pairs.iter().fold(0.0, |sum, (own, _)| sum + sighting_sigma_m(own).powi(2)) / count;
    let residual = |(own, other): &(Point3, Point3)| (map_from_camera.transform(own) - other).norm_squared();
    // Six numbers, or four, were fitted to three times as many as there are pairs.
    let freedom = (3.0 * count - if has_free_rotation { 6.0 } else { 4.0 }).max(1.0);
    let of_residuals = pairs.iter().map(residual).fold(0.0, |sum, squared| sum + squared) / freedom * 3.0;
    let variance = of_noise.max(of_residuals);
    let mean = pairs.iter().fold(Vector3::zeros(), |sum, (own, _)| sum + own.coords) / count;
    let spread = pairs.iter().fold(0.0, |sum, (own, _)| sum + (own.coords - mean).norm_squared());
    let tilt = match () {
        () if has_free_rotation => 0.0,
        () if assumed.contains(&Assumption::Upright) => ASSUMED_TILT_SIGMA_RAD,
        () => MEASURED_TILT_SIGMA_RAD,
    };
    let turn = (variance / 3.0 / spread.max(f64::MIN_POSITIVE)).sqrt().min(std::f64::consts::PI);
    let rotation_rad = libm::hypot(turn, tilt);
    let translation_m = libm::hypot((variance / count).sqrt(), mean.norm() * rotation_rad);
    Uncertainty { translation_m, rotation_rad }
}

/// Returns the standard deviations of a pose whose covariance is known: 6 by 6, row by row, of x, y, z in metres and the
/// rotation about X, Y, Z in radians.
pub fn of_covariance(covariance: &[f64; 36]) -> Uncertainty {
    let trace = |first: usize| (first..first + 3).fold(0.0, |sum, at| sum + covariance[at * 6 + at].max(0.0));
    Uncertainty { translation_m: trace(0).sqrt(), rotation_rad: trace(3).sqrt() }
}
