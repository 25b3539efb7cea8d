//! Search: how alike one global descriptor is to each of a map, exact and the same on every processor.

use std::collections::BTreeMap;

use super::block::{Block, inverse_length};
use crate::domain::bow::{BowVector, Score};
use crate::domain::global_descriptor::{GlobalDescriptor, GlobalEncoding};
use crate::geometry::hamming::count_ones;
use crate::geometry::instruction_set::{Kernel, dispatch};

/// Appends the likeness of every descriptor in the blocks, ascending by keyframe. It must be of their form.
pub(super) fn score_all(
    blocks: &BTreeMap<u32, Block>,
    sought: &GlobalDescriptor,
    scores: &mut Vec<(u32, Score)>,
) {
    let sought = Sought::new(sought);
    for block in blocks.values() {
        dispatch(Compare { block, sought: &sought, scores });
    }
}

/// A descriptor, laid out for the inner loop.
enum Sought {
    /// Signed bytes, widened once: products of 16-bit numbers are added in pairs by one instruction.
    Int8 { numbers: Vec<i16>, inverse_length: f64 },
    /// Bits in words of 64, and the bytes that are left.
    Bits { words: Vec<u64>, rest: Vec<u8> },
}

impl Sought {
    fn new(descriptor: &GlobalDescriptor) -> Self {
        let data = &descriptor.data;
        match descriptor.encoding {
            GlobalEncoding::Int8 => Self::Int8 {
                numbers: data.iter().map(|byte| i16::from(*byte as i8)).collect(),
                inverse_length: inverse_length(data),
            },
            GlobalEncoding::Bits => {
                let (words, rest) = data.as_chunks::<8>();
                let words = words.iter().map(|word| u64::from_le_bytes(*word)).collect();
                Self::Bits { words, rest: rest.to_vec() }
            }
        }
    }
}

/// One descriptor against those of a block.
struct Compare<'a> {
    block: &'a Block,
    sought: &'a Sought,
    scores: &'a mut Vec<(u32, Score)>,
}

impl Kernel for Compare<'_> {
    type Output = ();

    #[inline(always)]
    fn run<const POPCNT: bool>(self) {
        let Self { block, sought, scores } = self;
        let (keyframes, first) = (block.keyframes(), scores.len());
        scores.extend(keyframes.iter().map(|keyframe| (keyframe.0, Score::default())));
        let of_block = &mut scores[first..];
        match sought {
            Sought::Int8 { numbers, inverse_length } => {
                let lengths = block.inverse_lengths();
                for at in in_streams(keyframes.len()) {
                    let product = f64::from(dot(block.row(at), numbers));
                    of_block[at].1 = of_cosine(product * lengths[at] * inverse_length);
                }
            }
            Sought::Bits { words, rest } => {
                let bits = 8 * (8 * words.len() + rest.len()) as i32;
                let mut put = |at: usize, differing: u32| {
                    let cosine = f64::from(bits - 2 * differing as i32) / f64::from(bits);
                    of_block[at].1 = of_cosine(cosine);
                };
                let each = keyframes.len() / STREAMS;
                for turn in 0..each {
                    let places: [usize; STREAMS] = std::array::from_fn(|stream| stream * each + turn);
                    let rows = places.map(|at| block.row(at));
                    let differing = differing_bits::<POPCNT, STREAMS>(rows, words, rest);
                    places.into_iter().zip(differing).for_each(|(at, differing)| put(at, differing));
                }
                for at in STREAMS * each..keyframes.len() {
                    let [differing] = differing_bits::<POPCNT, 1>([block.row(at)], words, rest);
                    put(at, differing);
                }
            }
        }
    }
}

/// Parts of a block that are read in turn: processors fetch ahead within a page of memory, and while they begin one page the
/// others are there.
const STREAMS: usize = 4;

/// Returns the places of every row of a block, in turn from each of its parts.
#[inline(always)]
fn in_streams(rows: usize) -> impl Iterator<Item = usize> {
    let each = rows / STREAMS;
    let place = move |turn: usize| {
        if turn < STREAMS * each { turn % STREAMS * each + turn / STREAMS } else { turn }
    };
    (0..rows).map(place)
}

/// Returns the sum of products. It fits: 1,056 products are at most 2^14 each.
#[inline(always)]
fn dot(row: &[u8], numbers: &[i16]) -> i32 {
    row.iter().zip(numbers).map(|(a, b)| i32::from(i16::from(*a as i8)) * i32::from(*b)).sum()
}

/// Counts the bits in which several rows differ from one descriptor, word by word in step.
#[inline(always)]
fn differing_bits<const POPCNT: bool, const N: usize>(
    rows: [&[u8]; N],
    words: &[u64],
    rest: &[u8],
) -> [u32; N] {
    let own = rows.map(|row| row.as_chunks::<8>());
    let own_words = own.map(|(own, _)| &own[..words.len()]);
    let mut sums = [0_u64; N];
    for (at, word) in words.iter().enumerate() {
        for (sum, own) in sums.iter_mut().zip(own_words) {
            *sum += u64::from(count_ones::<POPCNT, 1>([u64::from_le_bytes(own[at]) ^ word]));
        }
    }
    std::array::from_fn(|row| {
        let of_rest: u32 = own[row].1.iter().zip(rest).map(|(a, b)| (a ^ b).count_ones()).sum();
        sums[row] as u32 + of_rest
    })
}

/// Returns the score of a cosine, in units of 2^-31: vectors at right angles or more have nothing in common. Bits count as
/// numbers that are 1 or -1.
#[inline(always)]
fn of_cosine(cosine: f64) -> Score {
    let units = cosine.clamp(0.0, 1.0) * f64::from(BowVector::ONE) + 0.5;
    Score::new((units as u32).min(BowVector::ONE), 0)
}
