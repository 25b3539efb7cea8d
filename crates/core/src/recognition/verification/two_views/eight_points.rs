//! The essential matrix through eight pairs of rays, and the normalisation that all linear fits share.

use nalgebra::{Matrix3, Vector3};

/// A pivot smaller than this, where the largest entries are about 1, leaves several matrices: the points lie on a plane, or
/// the camera only turned.
const MIN_PIVOT: f64 = 1e-8;

/// Returns the matrix with `x_candidate^T E x_query = 0` for eight pairs, its singular values made 1, 1, 0; none if the
/// pairs leave several.
pub(super) fn essential_of(
    pairs: impl Iterator<Item = (Vector3<f64>, Vector3<f64>)> + Clone,
) -> Option<Matrix3<f64>> {
    let of_query = normalisation(pairs.clone().map(|(query, _)| query))?;
    let of_candidate = normalisation(pairs.clone().map(|(_, candidate)| candidate))?;
    let mut rows = [[0.0; 9]; 8];
    for (row, (query, candidate)) in rows.iter_mut().zip(pairs) {
        let (q, c) = (of_query * query, of_candidate * candidate);
        *row = [c.x * q.x, c.x * q.y, c.x, c.y * q.x, c.y * q.y, c.y, q.x, q.y, 1.0];
    }
    let solution = null_vector(rows)?;
    let normalised = Matrix3::from_fn(|row, column| solution[row * 3 + column]);
    let svd = (of_candidate.transpose() * normalised * of_query).svd(true, true);
    let (u, v_t) = (svd.u?, svd.v_t?);
    Some(u * Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, 0.0)) * v_t)
}

/// Returns the vector that eight equations in nine unknowns leave: Gauss-Jordan elimination with full pivoting.
fn null_vector(mut rows: [[f64; 9]; 8]) -> Option<[f64; 9]> {
    let mut order: [usize; 9] = std::array::from_fn(|i| i);
    for step in 0..8 {
        let (mut best, mut row, mut column) = (0.0, step, step);
        for (i, entries) in rows.iter().enumerate().skip(step) {
            for (j, entry) in entries.iter().enumerate().skip(step) {
                if entry.abs() > best {
                    (best, row, column) = (entry.abs(), i, j);
                }
            }
        }
        if best < MIN_PIVOT {
            return None;
        }
        rows.swap(step, row);
        order.swap(step, column);
        for entries in &mut rows {
            entries.swap(step, column);
        }
        let pivot = rows[step];
        for (_, entries) in rows.iter_mut().enumerate().filter(|(i, _)| *i != step) {
            let factor = entries[step] / pivot[step];
            for (entry, of_pivot) in entries.iter_mut().zip(&pivot).skip(step) {
                *entry -= factor * of_pivot;
            }
        }
    }
    let mut solution = [0.0; 9];
    solution[order[8]] = 1.0;
    for (step, entries) in rows.iter().enumerate() {
        solution[order[step]] = -entries[8] / entries[step];
    }
    Some(solution)
}

/// Returns what moves the points' mean to the origin and their mean distance from it to the square root of 2;
/// none if they coincide.
pub(super) fn normalisation(points: impl Iterator<Item = Vector3<f64>> + Clone) -> Option<Matrix3<f64>> {
    let count = points.clone().count() as f64;
    let mean: Vector3<f64> = points.clone().sum::<Vector3<f64>>() / count;
    let spread = points.map(|point| (point - mean).norm()).sum::<f64>() / count;
    if !spread.is_finite() || spread <= f64::EPSILON {
        return None;
    }
    let scale = std::f64::consts::SQRT_2 / spread;
    Some(Matrix3::new(scale, 0.0, -scale * mean.x, 0.0, scale, -scale * mean.y, 0.0, 0.0, 1.0))
}
