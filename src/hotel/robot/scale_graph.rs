//! Scale graph: the units of a monocular robot's frames, from the ratios measured by odometry and loops.
//!
//! In the logarithm of the scale, this is linear least squares over a graph with one number per frame.

use factrs::core::{BetweenResidual, GaussNewton, GaussianNoise, Graph, PriorResidual, Values, VectorVar1};
use factrs::fac;
use factrs::optimizers::OptError;
use factrs::traits::Optimizer as _;

mod symbols {
    use factrs::assign_symbols;
    use factrs::core::VectorVar1;
    assign_symbols!(S: VectorVar1);
}
use symbols::S;

/// Standard deviation of the fixed first scale.
const ANCHOR_SIGMA: f64 = 1e-6;

/// A measured ratio of two frames' scales.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ratio {
    /// The number of the first frame.
    pub from: usize,
    /// The number of the second frame.
    pub to: usize,
    /// The natural logarithm of the scale of `to` over that of `from`.
    pub log_ratio: f64,
    /// Its standard deviation.
    pub sigma: f64,
}

/// Returns the logarithms of the scales that agree best with the ratios, from an initial guess; the first stays. None
/// if a scale is undetermined, or a ratio names a frame that does not exist.
pub fn solve(log_scales: &[f64], ratios: &[Ratio]) -> Option<Vec<f64>> {
    let first = *log_scales.first()?;
    if ratios.iter().any(|ratio| ratio.from.max(ratio.to) >= log_scales.len()) {
        return None;
    }
    let mut graph = Graph::new();
    let anchor = GaussianNoise::<1>::from_scalar_sigma(ANCHOR_SIGMA);
    graph.add_factor(fac![PriorResidual::new(VectorVar1::new(first)), S(0), anchor]);
    for ratio in ratios {
        let residual = BetweenResidual::new(VectorVar1::new(ratio.log_ratio));
        let noise = GaussianNoise::<1>::from_scalar_sigma(ratio.sigma);
        graph.add_factor(fac![residual, (S(ratio.from as u32), S(ratio.to as u32)), noise]);
    }
    let mut values = Values::new();
    for (number, log_scale) in log_scales.iter().enumerate() {
        values.insert(S(number as u32), VectorVar1::new(*log_scale));
    }
    let solved = match GaussNewton::new_default(graph).optimize(values) {
        Ok(solved) | Err(OptError::MaxIterations(solved)) => solved,
        Err(OptError::FailedToStep) => return Some(log_scales.to_vec()),
        Err(OptError::InvalidSystem) => return None,
    };
    let log_scale = |number: usize| {
        let solved: &VectorVar1 = solved.get(S(number as u32))?;
        Some(solved.0[0])
    };
    (0..log_scales.len()).map(log_scale).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ratio(from: usize, to: usize, log_ratio: f64, sigma: f64) -> Ratio {
        Ratio { from, to, log_ratio, sigma }
    }

    #[test]
    fn a_loop_is_shared_out_by_what_each_ratio_scatters_by() {
        // A chain with three unchanged ratios, one of them less certain, and a certain loop of 0.4 in total.
        let ratios = [
            ratio(0, 1, 0.0, 0.1),
            ratio(1, 2, 0.0, 0.1),
            ratio(2, 3, 0.0, 0.1 * 2.0_f64.sqrt()),
            ratio(0, 3, 0.4, 1e-4),
        ];
        let solved = solve(&[0.0; 4], &ratios).expect("a solution");
        for (solved, expected) in solved.iter().zip([0.0, 0.1, 0.2, 0.4]) {
            assert!((solved - expected).abs() < 1e-5, "{solved} instead of {expected}");
        }
    }

    #[test]
    fn a_ratio_to_nowhere_and_no_frame_have_no_solution() {
        assert_eq!(solve(&[0.0; 2], &[ratio(0, 2, 0.0, 0.1)]), None);
        assert_eq!(solve(&[], &[]), None);
    }
}
