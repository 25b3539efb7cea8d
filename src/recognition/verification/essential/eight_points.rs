//! The essential matrix that fits eight or more pairs of rays best.

use nalgebra::{Matrix3, SMatrix, SVector, Vector3};

/// The second smallest eigenvalue must exceed the smallest, noise included, by this factor, and this share of the
/// largest; else several matrices fit alike: the points lie on a plane, or the camera only turned.
const MIN_GAP: f64 = 10.0;
const MIN_SHARE: f64 = 1e-9;

/// `x_candidate^T E x_query = 0` for all pairs, in the sense of least squares, with singular values 1, 1, 0; `None` if the
/// pairs leave several.
pub(super) fn essential_of(
    pairs: impl Iterator<Item = (Vector3<f64>, Vector3<f64>)> + Clone,
) -> Option<Matrix3<f64>> {
    let of_query = normalisation(pairs.clone().map(|(query, _)| query))?;
    let of_candidate = normalisation(pairs.clone().map(|(_, candidate)| candidate))?;
    let mut normal = SMatrix::<f64, 9, 9>::zeros();
    for (query, candidate) in pairs {
        let (q, c) = (of_query * query, of_candidate * candidate);
        let row = SVector::<f64, 9>::from_fn(|i, _| c[i / 3] * q[i % 3]);
        normal += row * row.transpose();
    }
    let eigen = normal.symmetric_eigen();
    let mut order: [usize; 9] = std::array::from_fn(|i| i);
    order.sort_by(|a, b| eigen.eigenvalues[*a].total_cmp(&eigen.eigenvalues[*b]));
    let value = |rank: usize| eigen.eigenvalues[order[rank]].max(0.0);
    if value(1) < MIN_GAP * value(0) || value(1) < MIN_SHARE * value(8) {
        return None;
    }
    let solution = eigen.eigenvectors.column(order[0]);
    let normalised = Matrix3::from_fn(|row, column| solution[row * 3 + column]);
    let svd = (of_candidate.transpose() * normalised * of_query).svd(true, true);
    let (u, v_t) = (svd.u?, svd.v_t?);
    Some(u * Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, 0.0)) * v_t)
}

/// Moves the points' mean to the origin and their mean distance from it to the square root of 2.
fn normalisation(points: impl Iterator<Item = Vector3<f64>> + Clone) -> Option<Matrix3<f64>> {
    let count = points.clone().count() as f64;
    let mean: Vector3<f64> = points.clone().sum::<Vector3<f64>>() / count;
    let spread = points.map(|point| (point - mean).norm()).sum::<f64>() / count;
    if !spread.is_finite() || spread <= f64::EPSILON {
        return None;
    }
    let scale = std::f64::consts::SQRT_2 / spread;
    Some(Matrix3::new(scale, 0.0, -scale * mean.x, 0.0, scale, -scale * mean.y, 0.0, 0.0, 1.0))
}
