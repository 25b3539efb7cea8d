//! A flat or far scene: the projective map between its two images, which four matches determine.
//!
//! The direct linear transformation with normalised coordinates (R. Hartley, A. Zisserman, *Multiple View Geometry*, 2004,
//! algorithm 4.2), on the rays of calibrated cameras, and the symmetric transfer error (ibid., Eq. 4.7). Samples with three
//! points on a line are refused, and those whose triangles turn the other way: surfaces are seen from one side only.

use nalgebra::{Matrix3, SMatrix, SVector, Vector3};

use super::super::outcome::Model;
use super::consensus::SCORE_CHI_SQUARE;
use super::decomposition::motion_of;
use super::eight_points::normalisation;
use super::image_model::{Agreement, ImageModel, Settled};
use super::pairs::{RayPair, TwoViews};

/// The height of a triangle of three of the four points over its longest side, as a share of that side, must exceed this.
pub(in crate::recognition) const MIN_HEIGHT: f64 = 0.05;

/// The second smallest eigenvalue of the normal matrix must exceed this share of the largest: else several maps fit alike.
const MIN_SHARE: f64 = 1e-9;

/// A projective map between the ray planes `z = 1` of two cameras.
#[derive(Clone, Copy, Debug)]
pub struct Homography {
    /// Maps rays of the query to the candidate's; its determinant is 1.
    pub candidate_from_query: Matrix3<f64>,
    inverse: Matrix3<f64>,
}

impl Homography {
    /// Takes a map that keeps points before the cameras; none if it collapses the plane.
    pub fn new(map: &Matrix3<f64>) -> Option<Self> {
        let determinant = map.determinant();
        if !determinant.is_finite() || determinant == 0.0 {
            return None;
        }
        // The sign that keeps the side from which a plane is seen.
        let candidate_from_query = map / libm::cbrt(determinant);
        let inverse = candidate_from_query.try_inverse()?;
        Some(Self { candidate_from_query, inverse })
    }

    /// Fits four or more pairs, each as heavy as it is sharp.
    pub fn fit(pairs: impl Iterator<Item = RayPair> + Clone) -> Option<Self> {
        let of_query = normalisation(pairs.clone().map(|pair| pair.query.ray))?;
        let of_candidate = normalisation(pairs.clone().map(|pair| pair.candidate.ray))?;
        let mut normal = SMatrix::<f64, 9, 9>::zeros();
        for pair in pairs {
            let (q, c) = (of_query * pair.query.ray, of_candidate * pair.candidate.ray);
            let weight = (pair.query.sigma_px * pair.candidate.sigma_px).recip();
            // c x (H q) = 0: two independent rows, for the third coordinate of c is 1.
            let rows = [
                SVector::<f64, 9>::from([0.0, 0.0, 0.0, -q.x, -q.y, -1.0, c.y * q.x, c.y * q.y, c.y]),
                SVector::<f64, 9>::from([q.x, q.y, 1.0, 0.0, 0.0, 0.0, -c.x * q.x, -c.x * q.y, -c.x]),
            ];
            for row in rows {
                normal += row * row.transpose() * weight;
            }
        }
        let eigen = normal.symmetric_eigen();
        let mut order: [usize; 9] = std::array::from_fn(|i| i);
        order.sort_by(|a, b| eigen.eigenvalues[*a].total_cmp(&eigen.eigenvalues[*b]));
        if eigen.eigenvalues[order[1]] < MIN_SHARE * eigen.eigenvalues[order[8]] {
            return None;
        }
        let solution = eigen.eigenvectors.column(order[0]);
        let normalised = Matrix3::from_fn(|row, column| solution[row * 3 + column]);
        Self::new(&(of_candidate.try_inverse()? * normalised * of_query))
    }
}

impl ImageModel for Homography {
    const MODEL: Model = Model::Homography;
    const SAMPLE: usize = 4;
    /// With seven of ten matches false, 566 samples hold a good one with a chance of 99 %; with four of five, 2,876.
    const MAX_SAMPLES: u32 = 2_000;
    const MAX_CHI_SQUARE: f64 = SCORE_CHI_SQUARE;
    const AGREEMENT: Agreement = Agreement::AtPoint;

    fn of_sample(views: &TwoViews, places: &[usize]) -> Option<Self> {
        let chosen: [&RayPair; 4] = std::array::from_fn(|i| &views.pairs[places[i]]);
        if !is_sound(&chosen) {
            return None;
        }
        // In closed form: through the frame that the four points make in each image (ibid., section 4.4.1).
        let of_query = frame_of(&chosen.map(|pair| pair.query.ray))?;
        let of_candidate = frame_of(&chosen.map(|pair| pair.candidate.ray))?;
        let fitted = Self::new(&(of_candidate * of_query.try_inverse()?))?;
        let in_front = |pair: &&RayPair| (fitted.candidate_from_query * pair.query.ray).z > 0.0;
        chosen.iter().all(in_front).then_some(fitted)
    }

    fn refined(&self, views: &TwoViews, inliers: &[usize]) -> Option<Self> {
        if inliers.len() < Self::SAMPLE {
            return None;
        }
        Self::fit(inliers.iter().map(|place| views.pairs[*place]))
    }

    fn chi_squares(&self, views: &TwoViews, pair: &RayPair) -> [f64; 2] {
        transfer_chi_squares(views, pair, &self.candidate_from_query, &self.inverse)
    }

    fn settle(&self, views: &TwoViews, inliers: &[usize]) -> Settled {
        let rays: Vec<Vector3<f64>> = inliers.iter().map(|place| views.pairs[*place].query.ray).collect();
        let candidate_from_query = motion_of(&self.candidate_from_query, &rays);
        Settled { candidate_from_query, inliers: inliers.to_vec(), end: Ok(()) }
    }
}

/// Returns the squared errors of a map and its inverse, in the query's and in the candidate's image, in units of the
/// keypoint's variance; infinite where a ray is sent behind the camera.
pub(super) fn transfer_chi_squares(
    views: &TwoViews,
    pair: &RayPair,
    candidate_from_query: &Matrix3<f64>,
    query_from_candidate: &Matrix3<f64>,
) -> [f64; 2] {
    let chi_square = |sent: Vector3<f64>, seen: &Vector3<f64>, focal_px: [f64; 2], sigma_px: f64| {
        if sent.z <= 0.0 {
            return f64::INFINITY;
        }
        let (u, v) = ((sent.x / sent.z - seen.x) * focal_px[0], (sent.y / sent.z - seen.y) * focal_px[1]);
        (u * u + v * v) / (sigma_px * sigma_px)
    };
    let (query, candidate) = (&pair.query, &pair.candidate);
    [
        chi_square(query_from_candidate * candidate.ray, &query.ray, views.query_focal_px, query.sigma_px),
        chi_square(
            candidate_from_query * query.ray,
            &candidate.ray,
            views.candidate_focal_px,
            candidate.sigma_px,
        ),
    ]
}

/// Returns the matrix that sends the axes to three points and (1, 1, 1) to the fourth.
fn frame_of([a, b, c, d]: &[Vector3<f64>; 4]) -> Option<Matrix3<f64>> {
    let axes = Matrix3::from_columns(&[*a, *b, *c]);
    let weights = axes.try_inverse()? * d;
    Some(Matrix3::from_columns(&[a * weights.x, b * weights.y, c * weights.z]))
}

/// Whether four pairs can give a map worth testing. No three may lie on a line, and every three must turn alike in both images.
fn is_sound(sample: &[&RayPair; 4]) -> bool {
    let triples = [[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]];
    triples.into_iter().all(|triple| {
        let of_query = turning(triple.map(|i| sample[i].query.ray));
        let of_candidate = turning(triple.map(|i| sample[i].candidate.ray));
        of_query.zip(of_candidate).is_some_and(|(a, b)| a == b)
    })
}

/// Whether three points turn clockwise; none if they are on a line.
fn turning([a, b, c]: [Vector3<f64>; 3]) -> Option<bool> {
    let (ab, ac, bc) = (b - a, c - a, c - b);
    let area_2 = ab.x * ac.y - ab.y * ac.x;
    let longest_2 = ab.norm_squared().max(ac.norm_squared()).max(bc.norm_squared());
    (area_2.abs() > MIN_HEIGHT * longest_2).then_some(area_2 > 0.0)
}
