//! The uncertainty of a transformation: the covariance of its six numbers at the solution.
//!
//! With the normal matrix H and the gradients g of the pairs at the solution, the estimate scatters by
//! `H^-1 (sum of g g^T) H^-1`, times n / (n - 3) for the three pairs that define it (P. J. Huber, 1967; H. White,
//! "Maximum likelihood estimation of misspecified models", Econometrica 50, 1982). H alone would count each pair twice,
//! since its two images show the same two points, and would rest on the assumed sigmas: the gradients tell how far the
//! pairs really scatter. What all landmarks of a map share, such as drift, shows in none of them.

use nalgebra::{Matrix3, SMatrix};

use super::correspondence::{Cameras, Correspondence};
use super::normal_equations::{About, Scatter};
use crate::geometry::Sim3;
use crate::geometry::instruction_set::dispatch;

/// Pairs that define a transformation.
const DEFINING: f64 = 3.0;

/// Returns the covariance of `candidate_from_query`, row by row: x, y, z in metres and the rotation about X, Y, Z in
/// radians, in the candidate's camera frame, as ROS writes it; none where the pairs leave a direction open.
pub fn covariance(
    candidate_from_query: &Sim3,
    explained: &[Correspondence],
    cameras: &Cameras,
    fixed_scale: bool,
) -> Option<[f64; 36]> {
    let count = explained.len() as f64;
    if count <= DEFINING {
        return None;
    }
    let about = About::new(candidate_from_query, cameras);
    let [mut information, mut spread] = dispatch(Scatter { about, pairs: explained });
    if fixed_scale {
        for i in 0..6 {
            (information[(6, i)], information[(i, 6)]) = (0.0, 0.0);
            (spread[(6, i)], spread[(i, 6)]) = (0.0, 0.0);
        }
        (information[(6, 6)], spread[(6, 6)]) = (1.0, 0.0);
    }
    let inverse = information.cholesky()?.inverse();
    let of_step = inverse * spread * inverse * (count / (count - DEFINING));
    // A step turns by w about the candidate's origin, moves by t and grows by s, so the translation x changes by
    // t + w x x + s x.
    let [x, y, z] = candidate_from_query.translation_m();
    let mut change = SMatrix::<f64, 6, 7>::zeros();
    change.fixed_view_mut::<3, 3>(0, 0).copy_from(&-Matrix3::new(0.0, -z, y, z, 0.0, -x, -y, x, 0.0));
    change.fixed_view_mut::<3, 3>(0, 3).copy_from(&Matrix3::identity());
    change.fixed_view_mut::<3, 1>(0, 6).copy_from(&nalgebra::Vector3::new(x, y, z));
    change.fixed_view_mut::<3, 3>(3, 0).copy_from(&Matrix3::identity());
    let covariance = change * of_step * change.transpose();
    let rows: [f64; 36] = std::array::from_fn(|i| {
        // The same number on both sides of the diagonal, to the bit.
        let (row, column) = (i / 6, i % 6);
        covariance[(row.max(column), row.min(column))]
    });
    rows.iter().all(|number| number.is_finite()).then_some(rows)
}

#[cfg(test)]
mod tests;
