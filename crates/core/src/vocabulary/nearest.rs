//! The nearest of a node's children: the least Hamming distance, the first wins a tie.
//!
//! On a processor that counts bits, one child after the other is compared, a word an instruction. Else two children at a time
//! fill a 128-bit register, and LLVM counts the bits of both in step: half the time of one child at a time.

use crate::geometry::hamming::distance_by;
use crate::geometry::instruction_set::{Kernel, dispatch};

/// Returns the place among `block`, descriptors of `query.len()` words one after the other, of the nearest to `query`.
pub(super) fn nearest(query: &[u64], block: &[u64]) -> usize {
    dispatch(Nearest { query, block })
}

struct Nearest<'a> {
    query: &'a [u64],
    block: &'a [u64],
}

impl Kernel for Nearest<'_> {
    type Output = usize;

    #[inline(always)]
    fn run<const POPCNT: bool>(self) -> usize {
        match self.query.len() {
            4 => nearest_of::<POPCNT, 4>(self.query, self.block),
            6 => nearest_of::<POPCNT, 6>(self.query, self.block),
            8 => nearest_of::<POPCNT, 8>(self.query, self.block),
            _ => nearest_of::<POPCNT, ANY>(self.query, self.block),
        }
    }
}

/// In place of a number of words: any.
pub(super) const ANY: usize = 0;

/// [`nearest`] for descriptors of `N` words, inside a kernel.
#[inline(always)]
pub(super) fn nearest_of<const POPCNT: bool, const N: usize>(query: &[u64], block: &[u64]) -> usize {
    let each = if N == ANY { query.len() } else { N };
    let query = &query[..each];
    // Distance above, place below: the minimum is the nearest, and among equals the first.
    let mut best = u64::MAX;
    let mut place = 0;
    let mut children = block;
    if N != ANY && !POPCNT {
        let pairs = block.chunks_exact(2 * each);
        children = pairs.remainder();
        for pair in pairs {
            let (one, other) = pair.split_at(each);
            let mut distances = [0; 2];
            for word in 0..each {
                for (distance, child) in distances.iter_mut().zip([one, other]) {
                    *distance += u64::from((query[word] ^ child[word]).count_ones());
                }
            }
            for distance in distances {
                best = best.min(distance << 32 | place);
                place += 1;
            }
        }
    }
    for child in children.chunks_exact(each) {
        best = best.min(u64::from(distance_by::<POPCNT>(query, child)) << 32 | place);
        place += 1;
    }
    best as u32 as usize
}
