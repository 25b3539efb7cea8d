//! One split: members are parted into clusters around majority descriptors.

use super::majority::Majority;
use super::set::TrainingSet;
use crate::geometry::hamming::distance;
use crate::geometry::sampling::SplitMix64;
use crate::vocabulary::nearest::nearest;

/// Parts `members` into at most `k` clusters, and sorts them by cluster.
///
/// Returns each cluster's centre and size, none of them empty; two or more, unless all members are equal.
pub(super) fn split(
    set: &TrainingSet,
    members: &mut [u32],
    k: u32,
    rounds_max: u32,
    random: &mut SplitMix64,
) -> Vec<(Vec<u64>, usize)> {
    let each = set.descriptor(members[0]).len();
    let mut centres = seeds(set, members, k as usize, random);
    let mut clusters = assign(set, members, &centres, each);
    for _ in 0..rounds_max {
        let moved = majorities(set, members, &clusters, &centres, each);
        let again = assign(set, members, &moved, each);
        if again.iter().all(|&cluster| cluster == again[0]) {
            // The majorities of different clusters have become one.
            break;
        }
        centres = moved;
        if again == clusters {
            break;
        }
        clusters = again;
    }
    sort_by_cluster(members, &clusters);
    let mut sizes = vec![0; centres.len() / each];
    for &cluster in &clusters {
        sizes[cluster as usize] += 1;
    }
    let centres = centres.chunks_exact(each).map(<[u64]>::to_vec);
    centres.zip(sizes).filter(|(_, size)| *size > 0).collect()
}

/// Returns the first centres, as k-means++ draws them: each a member, the likelier the farther it is from those drawn
/// before. (k-means++ takes the square of the Euclidean distance; between bits that is the Hamming distance.)
fn seeds(set: &TrainingSet, members: &[u32], k: usize, random: &mut SplitMix64) -> Vec<u64> {
    let first = members[random.below(members.len())];
    let mut centres = set.descriptor(first).to_vec();
    let from_first = |&member: &u32| distance(set.descriptor(member), set.descriptor(first));
    let mut distances: Vec<u32> = members.iter().map(from_first).collect();
    for _ in 1..k {
        let total: u64 = distances.iter().copied().map(u64::from).sum();
        if total == 0 {
            break;
        }
        let mut left = random.below(total as usize) as u64;
        let drawn = distances.iter().position(|&distance| match left.checked_sub(u64::from(distance)) {
            Some(less) => {
                left = less;
                false
            }
            None => true,
        });
        let centre = set.descriptor(members[drawn.unwrap_or_default()]);
        centres.extend_from_slice(centre);
        for (least, &member) in distances.iter_mut().zip(members) {
            *least = (*least).min(distance(set.descriptor(member), centre));
        }
    }
    centres
}

fn assign(set: &TrainingSet, members: &[u32], centres: &[u64], each: usize) -> Vec<u32> {
    debug_assert!(centres.len().is_multiple_of(each), "whole centres");
    members.iter().map(|&member| nearest(set.descriptor(member), centres) as u32).collect()
}

/// Returns the majority of each cluster; one that lost all its members goes to the member farthest from its own centre.
fn majorities(
    set: &TrainingSet,
    members: &[u32],
    clusters: &[u32],
    centres: &[u64],
    each: usize,
) -> Vec<u64> {
    let mut counts: Vec<Majority> = (0..centres.len() / each).map(|_| Majority::new(each)).collect();
    for (&member, &cluster) in members.iter().zip(clusters) {
        counts[cluster as usize].add(set.descriptor(member));
    }
    let mut moved: Vec<u64> = Vec::with_capacity(centres.len());
    for count in &counts {
        moved.extend(count.descriptor());
    }
    let mut empty: Vec<usize> = (0..counts.len()).filter(|&at| counts[at].members() == 0).collect();
    if !empty.is_empty() {
        let to_centre = |at: usize| {
            let centre = clusters[at] as usize * each;
            distance(set.descriptor(members[at]), &moved[centre..centre + each])
        };
        let mut farthest: Vec<usize> = (0..members.len()).collect();
        farthest.sort_by_cached_key(|&at| std::cmp::Reverse(to_centre(at)));
        for (cluster, at) in empty.drain(..).zip(farthest) {
            moved[cluster * each..(cluster + 1) * each].copy_from_slice(set.descriptor(members[at]));
        }
    }
    moved
}

/// Cluster after cluster, the members of each in the order they had.
fn sort_by_cluster(members: &mut [u32], clusters: &[u32]) {
    let mut paired: Vec<(u32, u32)> = clusters.iter().copied().zip(members.iter().copied()).collect();
    paired.sort_by_key(|&(cluster, _)| cluster);
    for (member, (_, sorted)) in members.iter_mut().zip(paired) {
        *member = sorted;
    }
}
