//! Log-odds as whole numbers: a sum is the same in whatever order it is taken.

use std::iter::Sum;
use std::ops::{Add, Mul, Neg, Sub};

/// Natural log-odds, in thousandths.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct LogOdds(i64);

/// Units of one natural log-odds.
const UNITS: f64 = 1_000.0;

impl LogOdds {
    /// As likely as not.
    pub const EVEN: Self = Self(0);

    /// Returns a number of thousandths.
    pub const fn of_thousandths(thousandths: i64) -> Self {
        Self(thousandths)
    }

    /// Returns the nearest whole number of thousandths; bounds keep it finite.
    pub fn of(natural: f64) -> Self {
        Self((natural.clamp(-1e6, 1e6) * UNITS).round() as i64)
    }

    /// Returns the log-odds of a probability.
    pub fn of_probability(probability: f64) -> Self {
        Self::of(libm::log(probability / (1.0 - probability)))
    }

    /// Returns natural log-odds.
    pub const fn natural(self) -> f64 {
        self.0 as f64 / UNITS
    }

    /// Returns the probability, 0 to 1.
    pub fn probability(self) -> f64 {
        1.0 / (1.0 + libm::exp(-self.natural()))
    }
}

impl Add for LogOdds {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self(self.0 + other.0)
    }
}

impl Sub for LogOdds {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self(self.0 - other.0)
    }
}

impl Neg for LogOdds {
    type Output = Self;

    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl Mul<usize> for LogOdds {
    type Output = Self;

    fn mul(self, times: usize) -> Self {
        Self(self.0 * times as i64)
    }
}

impl Sum for LogOdds {
    fn sum<I: Iterator<Item = Self>>(terms: I) -> Self {
        terms.fold(Self::EVEN, Add::add)
    }
}
