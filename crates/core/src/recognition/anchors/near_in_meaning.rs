//! Near in meaning: the texts of a class whose embeddings are nearer to a text's than chance explains.
//!
//! The size of a cosine depends on the model and on what a class is about: unrelated paintings are at 0.4 with one
//! model, unrelated objects at 0.7 with another. So a text's own cosines are the measure: most others of its class
//! describe other objects. A text is near if fewer than [`NEAR_BY_CHANCE`] others would be so near by chance
//! (a-contrario, Desolneux, Moisan, Morel, 2000), taking the others for normally distributed about their median.

use std::f64::consts::SQRT_2;

/// Others that may be so near by chance.
pub(in crate::recognition) const NEAR_BY_CHANCE: f64 = 1.0;

/// With fewer others than this nothing is known of the chance, and the nearest are near.
pub(in crate::recognition) const OTHERS_MIN: usize = 8;

/// The standard deviation of a normal distribution over its median absolute deviation.
const SIGMA_PER_DEVIATION: f64 = 1.482_602_218_505_602;

/// Returns the positions of cosines that are near, the nearest first and of equals the first.
pub(in crate::recognition) fn near(cosines: &[f64]) -> Vec<usize> {
    let mut nearest: Vec<usize> = (0..cosines.len()).collect();
    nearest.sort_by(|a, b| cosines[*b].total_cmp(&cosines[*a]).then(a.cmp(b)));
    if cosines.len() >= OTHERS_MIN {
        let typical = median(cosines.to_vec());
        let sigma =
            SIGMA_PER_DEVIATION * median(cosines.iter().map(|cosine| (cosine - typical).abs()).collect());
        nearest.retain(|at| by_chance(cosines.len(), cosines[*at] - typical, sigma) < NEAR_BY_CHANCE);
    }
    nearest
}

/// Returns how many of `count` others are expected to be above the median by so much.
fn by_chance(count: usize, above: f64, sigma: f64) -> f64 {
    if sigma > 0.0 {
        return count as f64 * 0.5 * libm::erfc(above / (sigma * SQRT_2));
    }
    // More than half of the others are equally far.
    if above > 0.0 { 0.0 } else { count as f64 }
}

/// Returns the middle value, the upper one of two; of none, 0.
fn median(mut values: Vec<f64>) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_that_stand_out_are_near_whatever_is_usual_with_the_model() {
        // By hand: the median is 0.40 and the deviations 0.02, 0.02, 0.01, ...: their median is 0.02, sigma 0.0297.
        // 0.47 is 2.36 sigma above: 12 * 0.0091 = 0.11 by chance. 0.43 is 1.01 sigma above: 12 * 0.156 = 1.9.
        let usual = [0.38, 0.42, 0.39, 0.41, 0.40, 0.43, 0.37, 0.40, 0.38, 0.42];
        let with = |shift: f64, more: &[f64]| -> Vec<f64> {
            usual.iter().chain(more).map(|cosine| cosine + shift).collect()
        };
        for shift in [0.0, 0.3, -0.3] {
            assert_eq!(near(&with(shift, &[0.47, 0.9])), [11, 10], "shifted by {shift}");
        }
        assert_eq!(near(&with(0.0, &[])), [] as [usize; 0], "all are usual");
    }

    #[test]
    fn among_few_the_nearest_are_near_and_equals_are_all_far_or_one_stands_out() {
        assert_eq!(near(&[0.1, 0.9, 0.1, 0.5]), [1, 3, 0, 2]);
        assert_eq!(near(&[]), [] as [usize; 0]);
        assert_eq!(near(&[0.5; 9]), [] as [usize; 0]);
        let mut one = [0.5; 9];
        one[4] = 0.6;
        assert_eq!(near(&one), [4]);
    }
}
