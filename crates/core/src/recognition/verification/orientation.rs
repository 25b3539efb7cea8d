//! Matches that turn the image alike: when a camera rolls, all its keypoints turn by the same angle.

use super::descriptor_match::Match;
use crate::domain::keyframe::Keypoint;

/// Bins of 12 degrees (ORB-SLAM's `HISTO_LENGTH`).
pub(in crate::recognition) const BINS: usize = 30;

/// The fullest bins are kept (ORB-SLAM: 3, so that a peak across a border survives).
pub(in crate::recognition) const BINS_KEPT: usize = 3;

/// Keeps the matches in the fullest bins of the rotation from query to candidate. Does nothing if a keypoint of a
/// match has no orientation.
pub fn keep_consistent_rotations(matches: &mut Vec<Match>, query: &[Keypoint], candidate: &[Keypoint]) {
    let bins: Option<Vec<usize>> = matches
        .iter()
        .map(|found| {
            let from = query[found.query as usize].angle_deg?;
            let to = candidate[found.candidate as usize].angle_deg?;
            Some(bin(to - from))
        })
        .collect();
    let Some(bins) = bins else { return };
    let mut counts = [0_usize; BINS];
    for &bin in &bins {
        counts[bin] += 1;
    }
    let mut fullest: [usize; BINS] = std::array::from_fn(|bin| bin);
    fullest.sort_by_key(|&bin| (std::cmp::Reverse(counts[bin]), bin));
    let kept = &fullest[..BINS_KEPT];
    let mut bins = bins.into_iter();
    matches.retain(|_| bins.next().is_some_and(|bin| kept.contains(&bin)));
}

/// Returns the bin of an angle, the bins being centred on multiples of 12 degrees.
fn bin(angle_deg: f64) -> usize {
    let turns = (angle_deg / 360.0).rem_euclid(1.0);
    (turns * BINS as f64).round() as usize % BINS
}

#[cfg(test)]
mod tests {
    use super::*;

    fn turned(angle_deg: Option<f64>) -> Keypoint {
        Keypoint { u: 0.0, v: 0.0, octave: 0, angle_deg }
    }

    fn kept(angles: &[(Option<f64>, Option<f64>)]) -> Vec<u32> {
        let query: Vec<_> = angles.iter().map(|pair| turned(pair.0)).collect();
        let candidate: Vec<_> = angles.iter().map(|pair| turned(pair.1)).collect();
        let mut matches: Vec<_> =
            (0..angles.len() as u32).map(|i| Match { query: i, candidate: i, distance: 0 }).collect();
        keep_consistent_rotations(&mut matches, &query, &candidate);
        matches.iter().map(|found| found.query).collect()
    }

    #[test]
    fn matches_that_turn_otherwise_are_dropped() {
        let mut angles: Vec<_> =
            (0..40).map(|i| f64::from(i) * 9.0).map(|a| (Some(a), Some(a + 355.0))).collect();
        angles[10].1 = Some(angles[10].0.unwrap() + 90.0);
        angles[11].1 = Some(angles[11].0.unwrap() + 90.0);
        angles[20].1 = Some(angles[20].0.unwrap() + 180.0);
        angles[20].0 = angles[20].0.map(|a| a + 720.0);
        angles[30].1 = Some(angles[30].0.unwrap() - 90.0);
        // Three bins are kept: the true one, the pair's, and one of the two singles, the lower one (180 before 270).
        assert_eq!(kept(&angles), (0..40).filter(|&i| i != 30).collect::<Vec<u32>>());
    }

    #[test]
    fn without_an_orientation_nothing_is_dropped() {
        assert_eq!(
            kept(&[(Some(0.0), Some(10.0)), (None, Some(200.0)), (Some(5.0), Some(100.0))]),
            [0, 1, 2]
        );
    }
}
