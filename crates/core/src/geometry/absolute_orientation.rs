//! The similarity that best carries one set of points onto another, in closed form.
//!
//! B. K. P. Horn, "Closed-form solution of absolute orientation using unit quaternions", JOSA A 4 (1987), with the
//! least-squares scale of S. Umeyama, PAMI 13 (1991): minimises the sum of `|to - (s R from + t)|^2`. The rotation
//! comes as a unit quaternion, so a reflection cannot come out, whatever the points.

use nalgebra::{Matrix3, Matrix4, Quaternion, UnitQuaternion, Vector3};
use thiserror::Error;

use super::point::Point3;
use super::sim3::Sim3;

/// The rotation is unique if Horn's largest eigenvalue stands alone. Its gap to the next, as a share of it, is twice
/// the square of "width over length" of the points: below this they are on a line to within rounding.
const MIN_EIGENVALUE_GAP: f64 = 1e-9;

/// Whether the scale is part of the question.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// Both sides are metric: the scale is 1.
    Fixed,
    /// The two sides may differ in scale.
    Free,
}

/// Why there is no answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum Degenerate {
    /// Fewer than three pairs.
    #[error("{0} pairs of points; a similarity needs three")]
    TooFew(usize),
    /// All points of one side coincide.
    #[error("the points coincide")]
    Coincident,
    /// The points of one side are on a line, or the two sides are mirror images that no rotation is best for.
    #[error("the points leave the rotation open: they are on a line, or mirrored")]
    Ambiguous,
    /// A coordinate is not finite, or too large to square.
    #[error("a coordinate is not finite")]
    NotFinite,
}

/// Returns the `to_from_from` that carries `from` onto `to` with the least sum of squared distances.
pub fn align(pairs: &[(Point3, Point3)], scale: Scale) -> Result<Sim3, Degenerate> {
    if pairs.len() < 3 {
        return Err(Degenerate::TooFew(pairs.len()));
    }
    let count = pairs.len() as f64;
    let (from_sum, to_sum) = pairs
        .iter()
        .fold((Vector3::zeros(), Vector3::zeros()), |(f, t), (from, to)| (f + from.coords, t + to.coords));
    let (from_mean, to_mean) = (from_sum / count, to_sum / count);
    let (mut cross, mut from_spread, mut to_spread) = (Matrix3::zeros(), 0.0, 0.0);
    for (from, to) in pairs {
        let (from, to) = (from.coords - from_mean, to.coords - to_mean);
        cross += from * to.transpose();
        from_spread += from.norm_squared();
        to_spread += to.norm_squared();
    }
    if !(from_spread + to_spread).is_finite() {
        return Err(Degenerate::NotFinite);
    }
    if from_spread <= 0.0 || to_spread <= 0.0 {
        return Err(Degenerate::Coincident);
    }
    let rotation = best_rotation(&(cross / (from_spread * to_spread).sqrt()))?;
    let scale = match scale {
        Scale::Fixed => 1.0,
        // sum(to . R from) / sum(|from|^2), where sum(to . R from) is the trace of R cross.
        Scale::Free => (rotation.to_rotation_matrix().into_inner() * cross).trace() / from_spread,
    };
    if scale <= 0.0 {
        return Err(Degenerate::Ambiguous);
    }
    Ok(Sim3::from_parts(scale, rotation, to_mean - rotation * from_mean * scale))
}

/// Returns the rotation that maximises the sum of `to . R from`, from the normalised sum of `from to^T`.
pub fn best_rotation(cross: &Matrix3<f64>) -> Result<UnitQuaternion<f64>, Degenerate> {
    let s = cross;
    let (yz, zx, xy) = (s.m23 - s.m32, s.m31 - s.m13, s.m12 - s.m21);
    #[rustfmt::skip]
    let horn = Matrix4::new(
        s.m11 + s.m22 + s.m33, yz, zx, xy,
        yz, s.m11 - s.m22 - s.m33, s.m12 + s.m21, s.m31 + s.m13,
        zx, s.m12 + s.m21, s.m22 - s.m11 - s.m33, s.m23 + s.m32,
        xy, s.m31 + s.m13, s.m23 + s.m32, s.m33 - s.m11 - s.m22,
    );
    let eigen = horn.symmetric_eigen();
    let largest = eigen.eigenvalues.imax();
    let top = eigen.eigenvalues[largest];
    let next =
        (0..4).filter(|&i| i != largest).map(|i| eigen.eigenvalues[i]).fold(f64::NEG_INFINITY, f64::max);
    if top <= 0.0 || top - next <= MIN_EIGENVALUE_GAP * top {
        return Err(Degenerate::Ambiguous);
    }
    let q = eigen.eigenvectors.column(largest);
    // q and -q are one rotation; one sign, so that the answer is one too.
    let sign = if q[0] < 0.0 { -1.0 } else { 1.0 };
    Ok(UnitQuaternion::from_quaternion(Quaternion::new(q[0], q[1], q[2], q[3]) * sign))
}

#[cfg(test)]
mod tests;
