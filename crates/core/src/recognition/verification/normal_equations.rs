//! The normal equations of reprojection errors linearised about a transformation.

use nalgebra::{Matrix3, SMatrix, SVector, Vector3};

use super::correspondence::{Cameras, Correspondence, Hypothesis, Reprojection};
use super::huber::huber_weight;
use crate::geometry::Sim3;
use crate::geometry::instruction_set::Kernel;
use crate::geometry::pinhole::Pinhole;

/// Rotation, translation, logarithm of the scale.
pub(super) type Step = SVector<f64, 7>;

/// The numbers of a step.
const STEP: usize = 7;
/// A step filled up with zero: two of the widest registers that hold four numbers.
const LANES: usize = 8;
type Lanes = [f64; LANES];

/// A symmetric matrix and a vector, summed up over residuals.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct NormalEquations {
    /// Column by column; what is above the diagonal is not read.
    columns: [Lanes; STEP],
    gradient: Lanes,
}

/// One residual: how it changes with a step, its value and its weight.
struct Residual {
    jacobian: Lanes,
    value: f64,
    weight: f64,
}

impl NormalEquations {
    /// Adds one image of one point: a step `(w, t, s)` moves it by `outer * (w x inner + t + s inner)`.
    #[inline(always)]
    fn add(
        &mut self,
        it: &Reprojection,
        in_camera: &Vector3<f64>,
        inner: &Vector3<f64>,
        outer: &Matrix3<f64>,
        camera: &Pinhole,
    ) {
        let Some([u, v]) = it.residual_px(in_camera, camera) else { return };
        let weight = it.inverse_variance * huber_weight((u * u + v * v) * it.inverse_variance);
        let inverse_depth = in_camera.z.recip();
        let (x, y) = (in_camera.x * inverse_depth, in_camera.y * inverse_depth);
        let by_point = |row: [f64; 3]| row.map(|number| number * inverse_depth);
        let of_u = times(by_point([camera.fx, 0.0, -camera.fx * x]), outer);
        let of_v = times(by_point([0.0, camera.fy, -camera.fy * y]), outer);
        let in_u = Residual { jacobian: jacobian(of_u, inner), value: u, weight };
        let in_v = Residual { jacobian: jacobian(of_v, inner), value: v, weight };
        if let Some(depth) = it.depth {
            let value = in_camera.z - depth.metres;
            let inverse_variance = depth.inverse_sigma * depth.inverse_sigma;
            let weight = inverse_variance * huber_weight(value * value * inverse_variance);
            let row = [outer.m31, outer.m32, outer.m33];
            self.add_residuals([in_u, in_v, Residual { jacobian: jacobian(row, inner), value, weight }]);
        } else {
            self.add_residuals([in_u, in_v]);
        }
    }

    /// Adds residuals, one after the other in each number.
    #[inline(always)]
    fn add_residuals<const N: usize>(&mut self, residuals: [Residual; N]) {
        let mut weighted = [[0.0; LANES]; N];
        for (weighted, residual) in weighted.iter_mut().zip(&residuals) {
            for (weighted, number) in weighted.iter_mut().zip(residual.jacobian) {
                *weighted = number * residual.weight;
            }
        }
        for (column, sums) in self.columns.iter_mut().enumerate() {
            for (line, sum) in sums.iter_mut().enumerate() {
                for (weighted, residual) in weighted.iter().zip(&residuals) {
                    *sum += weighted[line] * residual.jacobian[column];
                }
            }
        }
        for (line, sum) in self.gradient.iter_mut().enumerate() {
            for (weighted, residual) in weighted.iter().zip(&residuals) {
                *sum += weighted[line] * residual.value;
            }
        }
    }

    /// Returns the damped step; `None` if the equations do not determine one.
    pub(super) fn solve(&self, damping: f64, fixed_scale: bool) -> Option<Step> {
        // Cholesky reads the lower triangle only.
        let mut information = SMatrix::<f64, STEP, STEP>::from_fn(|line, column| self.columns[column][line]);
        let mut gradient = Step::from_fn(|line, _| self.gradient[line]);
        for i in 0..STEP {
            information[(i, i)] *= 1.0 + damping;
        }
        if fixed_scale {
            for i in 0..6 {
                information[(6, i)] = 0.0;
            }
            information[(6, 6)] = 1.0;
            gradient[6] = 0.0;
        }
        Some(-information.cholesky()?.solve(&gradient))
    }
}

/// Returns `row * outer`, summed up as nalgebra does.
#[inline(always)]
fn times([a, b, c]: [f64; 3], outer: &Matrix3<f64>) -> [f64; 3] {
    [
        a * outer.m11 + b * outer.m21 + c * outer.m31,
        a * outer.m12 + b * outer.m22 + c * outer.m32,
        a * outer.m13 + b * outer.m23 + c * outer.m33,
    ]
}

/// Returns how a residual changes with a step, given how it changes as the point moves in the candidate's frame.
#[inline(always)]
fn jacobian([x, y, z]: [f64; 3], inner: &Vector3<f64>) -> Lanes {
    [
        inner.y * z - inner.z * y,
        inner.z * x - inner.x * z,
        inner.x * y - inner.y * x,
        x,
        y,
        z,
        x * inner.x + y * inner.y + z * inner.z,
        0.0,
    ]
}

/// The pairs at some places, to be linearised about a transformation.
pub(super) struct Linearise<'a> {
    pub about: About,
    pub pairs: &'a [Correspondence],
    pub places: &'a [u32],
}

impl Kernel for Linearise<'_> {
    type Output = NormalEquations;

    #[inline(always)]
    fn run<const POPCNT: bool>(self) -> NormalEquations {
        let mut sum = NormalEquations::default();
        for &place in self.places {
            self.about.add(&mut sum, &self.pairs[place as usize]);
        }
        sum
    }
}

/// The transformation that is linearised about; steps are in the candidate's frame.
pub(super) struct About {
    tested: Hypothesis,
    /// Moving the candidate's frame by a step moves its points by the inverse step.
    outer: Matrix3<f64>,
}

impl About {
    pub(super) fn new(candidate_from_query: &Sim3, cameras: &Cameras) -> Self {
        let tested = Hypothesis::new(cameras, candidate_from_query);
        Self { outer: -tested.query_from_candidate.linear, tested }
    }

    #[inline(always)]
    fn add(&self, sum: &mut NormalEquations, pair: &Correspondence) {
        let Hypothesis { cameras, candidate_from_query, query_from_candidate } = &self.tested;
        if let Some(it) = &pair.into_candidate {
            let moved = candidate_from_query.apply(&it.point);
            sum.add(it, &moved, &moved, &Matrix3::identity(), &cameras.candidate);
        }
        if let Some(it) = &pair.into_query {
            let moved = query_from_candidate.apply(&it.point);
            sum.add(it, &moved, &it.point, &self.outer, &cameras.query);
        }
    }
}

/// The sums over pairs of the normal matrix of each, and of the outer product of its gradient with itself.
pub(super) struct Scatter<'a> {
    pub about: About,
    pub pairs: &'a [Correspondence],
}

impl Kernel for Scatter<'_> {
    type Output = [SMatrix<f64, STEP, STEP>; 2];

    #[inline(always)]
    fn run<const POPCNT: bool>(self) -> Self::Output {
        let mut information = [[0.0; LANES]; STEP];
        let mut spread = [[0.0; LANES]; STEP];
        for pair in self.pairs {
            let mut of_pair = NormalEquations::default();
            self.about.add(&mut of_pair, pair);
            for column in 0..STEP {
                for line in 0..LANES {
                    information[column][line] += of_pair.columns[column][line];
                    spread[column][line] += of_pair.gradient[line] * of_pair.gradient[column];
                }
            }
        }
        [symmetric(&information), symmetric(&spread)]
    }
}

/// Returns the symmetric matrix of which the columns hold the lower triangle.
fn symmetric(columns: &[Lanes; STEP]) -> SMatrix<f64, STEP, STEP> {
    SMatrix::from_fn(|line, column| columns[line.min(column)][line.max(column)])
}
