//! Reliability: how often answers of one confidence are right.

use super::play::Located;

/// The lower ends of the bins of confidence.
pub const BINS: [f64; 5] = [0.0, 0.5, 0.9, 0.99, 0.999];

/// The answers of one bin.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Bin {
    /// The answers.
    pub answers: u64,
    /// Those that are right.
    pub right: u64,
    /// The sum of the confidences that they say.
    pub said: f64,
}

impl Bin {
    /// Returns the mean confidence; none without answers.
    pub fn mean_said(&self) -> Option<f64> {
        (self.answers > 0).then(|| self.said / self.answers as f64)
    }
}

/// Sorts answers into the bins. An answer about a place that nobody has mapped is wrong, whatever it names.
pub fn bins<'l>(located: impl Iterator<Item = &'l Located>) -> [Bin; BINS.len()] {
    let mut bins = [Bin::default(); BINS.len()];
    for answer in located {
        let at = BINS.iter().rposition(|low| answer.confidence >= *low).unwrap_or(0);
        bins[at].answers += 1;
        bins[at].right += u64::from(answer.is_right && answer.is_mapped);
        bins[at].said += answer.confidence;
    }
    bins
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_confidence_belongs_to_the_bin_that_it_reaches() {
        let answer = |confidence, is_right, is_mapped| Located { confidence, is_right, is_mapped };
        let answers = [
            answer(0.0, false, true),
            answer(0.9, true, true),
            answer(0.989, true, false),
            answer(1.0, true, true),
        ];
        let bins = bins(answers.iter());
        assert_eq!(bins.map(|bin| (bin.answers, bin.right)), [(1, 0), (0, 0), (2, 1), (0, 0), (1, 1)]);
        assert_eq!(bins[2].mean_said(), Some(0.9_f64.midpoint(0.989)));
    }
}
