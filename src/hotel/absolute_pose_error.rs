//! stub until the helper's
use crate::geometry::Point3;
use crate::geometry::absolute_orientation::{Scale, align};
/// RMSE
pub fn rmse_after_alignment(estimated: &[Point3], truth: &[Point3]) -> Option<f64> {
    let pairs: Vec<(Point3, Point3)> = estimated.iter().copied().zip(truth.iter().copied()).collect();
    let t = align(&pairs, Scale::Fixed).ok()?;
    let sum: f64 = pairs.iter().map(|(e, r)| (t.transform(e) - r).norm_squared()).sum();
    Some((sum / pairs.len() as f64).sqrt())
}
