//! Huber's function: the square of small errors, the size of large ones, so that outliers weigh less.

/// Errors beyond this many standard deviations weigh less (P. J. Huber: 95 % efficiency on normal errors).
const HUBER_SIGMAS: f64 = 1.345;

/// Returns the weight of an error in least squares, given its square in units of its variance.
#[inline(always)]
pub(super) fn huber_weight(chi_square: f64) -> f64 {
    if chi_square <= HUBER_SIGMAS * HUBER_SIGMAS { 1.0 } else { HUBER_SIGMAS / chi_square.sqrt() }
}

/// Returns the cost of an error, given its square in units of its variance.
#[inline(always)]
pub(super) fn huber_cost(chi_square: f64) -> f64 {
    if chi_square <= HUBER_SIGMAS * HUBER_SIGMAS {
        chi_square
    } else {
        HUBER_SIGMAS * (2.0 * chi_square.sqrt() - HUBER_SIGMAS)
    }
}
