//! Fusion of the channels' rankings: by reciprocal rank, which asks nothing of scores that cannot be compared.

use std::cmp::Ordering;
use std::collections::BTreeMap;

/// What is added to each rank: the larger, the less the first ranks stand out.
pub(in crate::recognition) const RECIPROCAL_RANK_OFFSET: f64 = 60.0;

/// Returns everything that a channel ranks, with its channels: first those with the greatest sum of 1 / (offset + rank),
/// ranks counted from 1. `tie` orders equal sums.
pub(in crate::recognition) fn fuse<T: Copy + Ord, C: Copy>(
    rankings: &[(C, Vec<T>)],
    tie: impl Fn(T, T) -> Ordering,
) -> Vec<(T, Vec<C>)> {
    let mut found: BTreeMap<T, (f64, Vec<C>)> = BTreeMap::new();
    for (channel, ranking) in rankings {
        for (before, keyframe) in ranking.iter().enumerate() {
            let (sum, channels) = found.entry(*keyframe).or_default();
            *sum += 1.0 / (RECIPROCAL_RANK_OFFSET + before as f64 + 1.0);
            channels.push(*channel);
        }
    }
    let mut fused: Vec<_> = found.into_iter().collect();
    fused.sort_by(|(a, (sum_a, _)), (b, (sum_b, _))| sum_b.total_cmp(sum_a).then_with(|| tie(*a, *b)));
    fused.into_iter().map(|(keyframe, (_, channels))| (keyframe, channels)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::domain::channel::Channel;
    use crate::domain::ids::KeyframeSeq;

    #[test]
    fn what_two_channels_rank_second_comes_before_what_one_ranks_first() {
        let ranked = |numbers: &[u32]| numbers.iter().copied().map(KeyframeSeq).collect::<Vec<_>>();
        let rankings = [(Channel::Bow, ranked(&[1, 2, 3])), (Channel::Global, ranked(&[4, 2, 5]))];
        let fused = fuse(&rankings, |a, b| b.cmp(&a));
        // 2/62, then 1/61 twice and 1/63 twice, with ties as the caller orders them.
        assert_eq!(fused.iter().map(|(keyframe, _)| keyframe.0).collect::<Vec<_>>(), [2, 4, 1, 5, 3]);
        assert_eq!(fused[0].1, [Channel::Bow, Channel::Global]);
        assert_eq!(fused[1].1, [Channel::Global]);
    }
}
