//! A feature of the query and one of the candidate that may be one point, and how well a transformation explains the pair.

use nalgebra::{Matrix3, Vector3};

use crate::geometry::Sim3;
use crate::geometry::instruction_set::{Kernel, dispatch};
use crate::geometry::pinhole::Pinhole;

/// A point known in one camera's frame, and where the other camera's image shows it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reprojection {
    /// The point in the frame of the camera it comes from.
    pub point: Vector3<f64>,
    /// Where the image of the other camera shows it, in pixels.
    pub pixel: [f64; 2],
    /// The inverse variance of that pixel, per square pixel.
    pub inverse_variance: f64,
    /// How deep that camera's own map has it, if it has.
    pub depth: Option<Depth>,
}

/// A depth as a camera's own map has it: the z coordinate in the camera's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Depth {
    /// In metres, positive.
    pub metres: f64,
    /// The inverse of its standard deviation.
    pub inverse_sigma: f64,
}

impl Reprojection {
    /// Returns how far off the pixel is in x and y; `None` if the point falls behind the camera.
    #[inline(always)]
    pub fn residual_px(&self, point_in_camera: &Vector3<f64>, camera: &Pinhole) -> Option<[f64; 2]> {
        let [u, v] = camera.project(point_in_camera)?;
        Some([u - self.pixel[0], v - self.pixel[1]])
    }

    /// Returns the squared errors in the image and in depth, in units of their variances; infinite if the point falls
    /// behind the camera.
    #[inline(always)]
    pub(super) fn chi_squares(&self, map: &Map, camera: &Pinhole) -> [f64; 2] {
        let point = map.apply(&self.point);
        let Some([u, v]) = self.residual_px(&point, camera) else { return [f64::INFINITY; 2] };
        let in_depth = match self.depth {
            Some(depth) => (point.z - depth.metres) * depth.inverse_sigma,
            None => 0.0,
        };
        [(u * u + v * v) * self.inverse_variance, in_depth * in_depth]
    }

    #[inline(always)]
    fn chi_square(&self, map: &Map, camera: &Pinhole) -> f64 {
        let [in_image, in_depth] = self.chi_squares(map, camera);
        in_image.max(in_depth)
    }
}

/// A pair that may be one point. At least one of the two is there; with a position on both sides, both are.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Correspondence {
    /// The candidate's point, to be seen in the query's image.
    pub into_query: Option<Reprojection>,
    /// The query's point, to be seen in the candidate's image.
    pub into_candidate: Option<Reprojection>,
    /// The number of bits in which the descriptors differ.
    pub distance: u32,
    /// The feature of the query.
    pub query_feature: u32,
    /// The feature of the candidate; `None` for a landmark that only its neighbours saw.
    pub candidate_feature: Option<u32>,
}

impl Correspondence {
    /// Whether the candidate itself sees it, and both sides have a position for it.
    pub fn is_located(&self) -> bool {
        self.candidate_feature.is_some() && self.into_query.is_some() && self.into_candidate.is_some()
    }
}

/// The two cameras.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cameras {
    /// The query's.
    pub query: Pinhole,
    /// The candidate's.
    pub candidate: Pinhole,
}

/// A similarity as matrix and vector, for loops over many points.
#[derive(Clone, Copy, Debug)]
pub(super) struct Map {
    pub(super) linear: Matrix3<f64>,
    translation: Vector3<f64>,
}

impl Map {
    pub(super) fn of(sim3: &Sim3) -> Self {
        let (linear, translation) = sim3.linear_and_translation();
        Self { linear, translation }
    }

    /// Returns a mapped point: `linear * point + translation`, written out so that it is inlined into kernels.
    #[inline(always)]
    pub(super) fn apply(&self, point: &Vector3<f64>) -> Vector3<f64> {
        let (m, t) = (&self.linear, &self.translation);
        Vector3::new(
            m.m11 * point.x + m.m12 * point.y + m.m13 * point.z + t.x,
            m.m21 * point.x + m.m22 * point.y + m.m23 * point.z + t.y,
            m.m31 * point.x + m.m32 * point.y + m.m33 * point.z + t.z,
        )
    }
}

/// A transformation between two cameras, ready to be tested on correspondences.
#[derive(Clone, Copy, Debug)]
pub struct Hypothesis {
    pub(super) cameras: Cameras,
    /// The transformation of points of the query's frame into the candidate's.
    pub(super) candidate_from_query: Map,
    pub(super) query_from_candidate: Map,
}

impl Hypothesis {
    /// Prepares a transformation.
    pub fn new(cameras: &Cameras, candidate_from_query: &Sim3) -> Self {
        Self {
            cameras: *cameras,
            candidate_from_query: Map::of(candidate_from_query),
            query_from_candidate: Map::of(&candidate_from_query.inverse()),
        }
    }

    /// Returns the worse of the squared errors in the two images, in units of the keypoint's variance; infinite if a
    /// point falls behind a camera.
    #[inline(always)]
    pub fn chi_square(&self, pair: &Correspondence) -> f64 {
        let in_query = match &pair.into_query {
            Some(it) => it.chi_square(&self.query_from_candidate, &self.cameras.query),
            None => 0.0,
        };
        let in_candidate = match &pair.into_candidate {
            Some(it) => it.chi_square(&self.candidate_from_query, &self.cameras.candidate),
            None => 0.0,
        };
        in_query.max(in_candidate)
    }

    /// Returns the sum of the errors of a pair in both images, in pixels, and how many images that is.
    pub fn error_px(&self, pair: &Correspondence) -> (f64, u32) {
        let sides = [
            (pair.into_query, &self.query_from_candidate, &self.cameras.query),
            (pair.into_candidate, &self.candidate_from_query, &self.cameras.candidate),
        ];
        sides.into_iter().fold((0.0, 0), |(sum, count), (side, map, camera)| match side {
            Some(it) => match it.residual_px(&map.apply(&it.point), camera) {
                Some([u, v]) => (sum + (u * u + v * v).sqrt(), count + 1),
                None => (sum, count),
            },
            None => (sum, count),
        })
    }

    /// Returns the places of the pairs whose error in both images is below the limit.
    pub fn inliers(&self, pairs: &[Correspondence], max_chi_square: f64) -> Vec<u32> {
        dispatch(Inliers { hypothesis: self, pairs, max_chi_square })
    }

    /// Returns the pairs whose error in both images is below the limit.
    pub fn explained(&self, pairs: &[Correspondence], max_chi_square: f64) -> Vec<Correspondence> {
        self.inliers(pairs, max_chi_square).iter().map(|&place| pairs[place as usize]).collect()
    }
}

/// Pairs to be tested.
struct Inliers<'a> {
    hypothesis: &'a Hypothesis,
    pairs: &'a [Correspondence],
    max_chi_square: f64,
}

impl Kernel for Inliers<'_> {
    type Output = Vec<u32>;

    #[inline(always)]
    fn run<const POPCNT: bool>(self) -> Vec<u32> {
        let mut inliers = Vec::with_capacity(self.pairs.len());
        for (place, pair) in (0..).zip(self.pairs) {
            if self.hypothesis.chi_square(pair) < self.max_chi_square {
                inliers.push(place);
            }
        }
        inliers
    }
}
