//! A camera that moved in a scene with depth: the essential matrix.
//!
//! The epipolar constraint x_c^T E x_q = 0 (H. C. Longuet-Higgins 1981; eight points normalised as R. Hartley, PAMI 1997),
//! refined over the rotation and the *direction* of the translation, five unknowns; its length is not known and reported
//! as 1. A camera that only turned has no such direction: then it says so.

use nalgebra::{Matrix3, Rotation3, SMatrix, SVector, UnitQuaternion, Vector3};

use super::super::outcome::{Failure, Model};
use super::eight_points::essential_of;
use super::image_model::{Agreement, ImageModel, Settled};
use super::pairs::{RayPair, TwoViews};
use super::rotation::Rotation;
use crate::geometry::Sim3;

/// Below this median angle, in radians (half a degree), between the rays of one point after the best rotation, the camera
/// has only turned, and the translation is noise.
pub(in crate::recognition) const MIN_PARALLAX_RAD: f64 = 0.0087;

/// Steps of the refinement; it converges in two or three.
const STEPS: u32 = 3;

/// The damping of the refinement, as a share of the diagonal: little parallax leaves the direction nearly open.
const DAMPING: f64 = 1e-6;

/// An essential matrix.
#[derive(Clone, Copy, Debug)]
pub struct Essential {
    matrix: Matrix3<f64>,
}

impl ImageModel for Essential {
    const MODEL: Model = Model::Essential;
    const SAMPLE: usize = 8;
    /// With half of the matches false, one sample of 256 is good.
    const MAX_SAMPLES: u32 = 1_500;
    /// The 99 % quantile of chi-square with one degree of freedom: a point lies on a line (ORB-SLAM: 95 %, 3.84).
    const MAX_CHI_SQUARE: f64 = 6.63;
    const AGREEMENT: Agreement = Agreement::AlongLine;

    fn of_sample(views: &TwoViews, places: &[usize]) -> Option<Self> {
        let rays = places.iter().map(|place| rays_of(&views.pairs[*place]));
        essential_of(rays).map(|matrix| Self { matrix })
    }

    fn refined(&self, views: &TwoViews, inliers: &[usize]) -> Option<Self> {
        let [mut rotation, _] = self.rotations()?;
        let mut direction = self.direction()?;
        for _ in 0..STEPS {
            (rotation, direction) = stepped(&rotation, &direction, views, inliers)?;
        }
        Some(Self { matrix: direction.cross_matrix() * rotation })
    }

    /// Returns the squared distances from the epipolar lines.
    fn chi_squares(&self, views: &TwoViews, pair: &RayPair) -> [f64; 2] {
        let line = self.matrix * pair.query.ray;
        let back = self.matrix.transpose() * pair.candidate.ray;
        let error = pair.candidate.ray.dot(&line);
        let chi_square = |line: &Vector3<f64>, [fx, fy]: [f64; 2], sigma_px: f64| {
            let (x, y) = (line.x / fx, line.y / fy);
            let slope_2 = (x * x + y * y) * sigma_px * sigma_px;
            // At the epipole every direction fits.
            if slope_2 > 0.0 { error * error / slope_2 } else { f64::INFINITY }
        };
        [
            chi_square(&back, views.query_focal_px, pair.query.sigma_px),
            chi_square(&line, views.candidate_focal_px, pair.candidate.sigma_px),
        ]
    }

    fn settle(&self, views: &TwoViews, inliers: &[usize]) -> Settled {
        let Some((candidate_from_query, inliers)) = self.motion(views, inliers) else {
            return Settled { candidate_from_query: None, inliers: Vec::new(), end: Ok(()) };
        };
        let parallax_rad = parallax_beside_rotation(views, &inliers);
        let millidegrees = |angle: f64| (angle.to_degrees() * 1e3).round() as u32;
        let end = if parallax_rad < MIN_PARALLAX_RAD {
            let (millidegrees, limit) = (millidegrees(parallax_rad), millidegrees(MIN_PARALLAX_RAD));
            Err(Failure::TooLittleParallax { millidegrees, limit })
        } else {
            Ok(())
        };
        Settled { candidate_from_query: Some(candidate_from_query), inliers, end }
    }
}

impl Essential {
    /// Returns the direction of the translation, up to its sign.
    fn direction(&self) -> Option<Vector3<f64>> {
        Some(self.matrix.svd(true, false).u?.column(2).into_owned())
    }

    /// Returns the two rotations that it allows.
    fn rotations(&self) -> Option<[Matrix3<f64>; 2]> {
        let svd = self.matrix.svd(true, true);
        let (u, v_t) = (svd.u?, svd.v_t?);
        let w = Matrix3::new(0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0);
        let proper = |turned: Matrix3<f64>| if turned.determinant() < 0.0 { -turned } else { turned };
        Some([proper(u * w * v_t), proper(u * w.transpose() * v_t)])
    }

    /// Returns the rotation and the unit translation that put most inliers in front of both cameras; and those inliers.
    fn motion(&self, views: &TwoViews, inliers: &[usize]) -> Option<(Sim3, Vec<usize>)> {
        let t = self.direction()?;
        let mut best: Option<(Matrix3<f64>, Vector3<f64>, Vec<usize>)> = None;
        for rotation in self.rotations()? {
            for direction in [t, -t] {
                let is_kept = |place: &usize| is_in_front(&views.pairs[*place], &rotation, &direction);
                let front: Vec<usize> = inliers.iter().copied().filter(is_kept).collect();
                if best.as_ref().is_none_or(|(.., known)| front.len() > known.len()) {
                    best = Some((rotation, direction, front));
                }
            }
        }
        let (rotation, direction, front) = best?;
        let rotation = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(rotation));
        Some((Sim3::from_parts(1.0, rotation, direction), front))
    }
}

fn rays_of(pair: &RayPair) -> (Vector3<f64>, Vector3<f64>) {
    (pair.query.ray, pair.candidate.ray)
}

/// Moves the rotation and the direction by one Gauss-Newton step on Sampson's distances of the inliers.
fn stepped(
    rotation: &Matrix3<f64>,
    direction: &Vector3<f64>,
    views: &TwoViews,
    inliers: &[usize],
) -> Option<(Matrix3<f64>, Vector3<f64>)> {
    let matrix = direction.cross_matrix() * rotation;
    // Two directions square to the translation's.
    let axis = if direction.x.abs() < 0.6 { Vector3::x() } else { Vector3::y() };
    let first = direction.cross(&axis).normalize();
    let second = direction.cross(&first);
    let (mut normal, mut gradient) = (SMatrix::<f64, 5, 5>::zeros(), SVector::<f64, 5>::zeros());
    for place in inliers {
        let pair = &views.pairs[*place];
        let (q, c) = rays_of(pair);
        let (line, back) = (matrix * q, matrix.transpose() * c);
        let slope = |line: &Vector3<f64>, [fx, fy]: [f64; 2], sigma_px: f64| {
            let (x, y) = (line.x * sigma_px / fx, line.y * sigma_px / fy);
            x * x + y * y
        };
        let variance = slope(&line, views.candidate_focal_px, pair.candidate.sigma_px)
            + slope(&back, views.query_focal_px, pair.query.sigma_px);
        if variance <= 0.0 {
            continue;
        }
        // c . (t x R q): its change with a turn w is w . (R q x (c x t)), with a move d it is d . (R q x c).
        let turned = rotation * q;
        let by_turn = turned.cross(&c.cross(direction));
        let by_move = turned.cross(&c);
        let jacobian = SVector::<f64, 5>::from([
            by_turn.x,
            by_turn.y,
            by_turn.z,
            by_move.dot(&first),
            by_move.dot(&second),
        ]);
        normal += jacobian * jacobian.transpose() / variance;
        gradient += jacobian * (c.dot(&line) / variance);
    }
    for i in 0..5 {
        normal[(i, i)] *= 1.0 + DAMPING;
    }
    let step = -normal.cholesky()?.solve(&gradient);
    let half = step.fixed_rows::<3>(0) * 0.5;
    // Cayley's map: to first order the exponential, and it needs no sine.
    let turn = UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(1.0, half.x, half.y, half.z));
    let moved = direction + first * step[3] + second * step[4];
    Some((turn.to_rotation_matrix().into_inner() * rotation, moved.try_normalize(1e-12)?))
}

/// Whether the point where the two rays come nearest lies in front of both cameras.
fn is_in_front(pair: &RayPair, rotation: &Matrix3<f64>, direction: &Vector3<f64>) -> bool {
    // depth_c * candidate = depth_q * (R query) + t, in the sense of least squares.
    let (a, b) = (rotation * pair.query.ray, pair.candidate.ray);
    let (aa, ab, bb) = (a.dot(&a), a.dot(&b), b.dot(&b));
    let determinant = aa * bb - ab * ab;
    if determinant <= f64::EPSILON {
        return false;
    }
    let (at, bt) = (a.dot(direction), b.dot(direction));
    let depth_of_query = (ab * bt - bb * at) / determinant;
    let depth_of_candidate = (aa * bt - ab * at) / determinant;
    depth_of_query > 0.0 && depth_of_candidate > 0.0
}

/// Returns the median angle that is left between the two rays of a point after the rotation that aligns them best, in radians.
fn parallax_beside_rotation(views: &TwoViews, inliers: &[usize]) -> f64 {
    let Some(rotation) = Rotation::fit(inliers.iter().map(|place| views.pairs[*place])) else { return 0.0 };
    let angle = |place: &usize| {
        let (a, b) = (rotation.turn(&views.pairs[*place].query.ray), views.pairs[*place].candidate.ray);
        libm::atan2(a.cross(&b).norm(), a.dot(&b))
    };
    let mut angles: Vec<f64> = inliers.iter().map(angle).collect();
    angles.sort_by(f64::total_cmp);
    angles.get(angles.len() / 2).copied().unwrap_or(0.0)
}
