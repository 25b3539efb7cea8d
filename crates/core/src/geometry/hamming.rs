//! Hamming distance of binary descriptors, packed into 64-bit words.
//!
//! Bits are counted by one instruction a word where the processor has it ([`super::instruction_set`]), else in parallel
//! within words. One descriptor is compared with many at once, held by *columns* (word 0 of all, word 1 of all, ...), which
//! compilers turn into vector instructions of whatever width there is.

use super::instruction_set::{Kernel, dispatch};

/// The longest descriptor that can be packed, in words: its distances still fit in 16 bits.
pub const MAX_WORDS: usize = 1023;

/// Returns the number of bits in which two descriptors of one length differ.
///
/// Loops over many pairs are better off in a kernel, with [`distance_by`].
pub fn distance(a: &[u64], b: &[u64]) -> u32 {
    debug_assert_eq!(a.len(), b.len());
    distance_by::<{ cfg!(target_feature = "popcnt") }>(a, b)
}

/// Returns the same for a length known to the compiler.
pub fn distance_fixed<const N: usize>(a: &[u64; N], b: &[u64; N]) -> u32 {
    distance_of::<{ cfg!(target_feature = "popcnt") }, N>(a, b)
}

/// [`distance`], inside a kernel.
#[inline(always)]
pub(crate) fn distance_by<const POPCNT: bool>(a: &[u64], b: &[u64]) -> u32 {
    match (a.len(), b.len()) {
        (4, 4) => distance_of::<POPCNT, 4>(a, b),
        (6, 6) => distance_of::<POPCNT, 6>(a, b),
        (8, 8) => distance_of::<POPCNT, 8>(a, b),
        _ => a.iter().zip(b).map(|(a, b)| count_ones::<POPCNT, 1>([a ^ b])).sum(),
    }
}

#[inline(always)]
fn distance_of<const POPCNT: bool, const N: usize>(a: &[u64], b: &[u64]) -> u32 {
    let mut differing = [0; N];
    for (word, (a, b)) in differing.iter_mut().zip(a.iter().zip(b)) {
        *word = a ^ b;
    }
    count_ones::<POPCNT, N>(differing)
}

/// Counts the bits of up to 30 words; without an instruction for it, adds bytes before adding across them.
#[inline(always)]
pub(crate) fn count_ones<const POPCNT: bool, const N: usize>(words: [u64; N]) -> u32 {
    const { assert!(N <= 30, "a byte counts at most 255") };
    if POPCNT {
        // Summed up in words, too: narrower sums would be packed after each.
        return words.iter().map(|word| u64::from(word.count_ones())).sum::<u64>() as u32;
    }
    let mut bytes = 0;
    for three in words.chunks(3) {
        // Four-bit counters hold the sum of three words: at most 12.
        let nibbles: u64 = three.iter().map(|&word| nibble_counts(word)).sum();
        bytes += (nibbles & 0x0f0f_0f0f_0f0f_0f0f) + ((nibbles >> 4) & 0x0f0f_0f0f_0f0f_0f0f);
    }
    let shorts = (bytes & 0x00ff_00ff_00ff_00ff) + ((bytes >> 8) & 0x00ff_00ff_00ff_00ff);
    let halves = shorts + (shorts >> 32);
    ((halves + (halves >> 16)) & 0xffff) as u32
}

/// Returns how many bits are set in each group of four.
#[inline(always)]
fn nibble_counts(word: u64) -> u64 {
    let pairs = word - ((word >> 1) & 0x5555_5555_5555_5555);
    (pairs & 0x3333_3333_3333_3333) + ((pairs >> 2) & 0x3333_3333_3333_3333)
}

/// Descriptors of one length, one after the other.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PackedDescriptors {
    words_each: usize,
    words: Vec<u64>,
}

impl PackedDescriptors {
    /// From bytes as a client sends them, `descriptor_bytes` each; `None` unless that is a positive multiple of 8, up to
    /// [`MAX_WORDS`] words, and divides the bytes.
    pub fn from_bytes(descriptor_bytes: usize, bytes: &[u8]) -> Option<Self> {
        let is_packable = descriptor_bytes > 0
            && descriptor_bytes.is_multiple_of(8)
            && descriptor_bytes <= 8 * MAX_WORDS
            && bytes.len().is_multiple_of(descriptor_bytes);
        is_packable.then(|| {
            let words = bytes.as_chunks::<8>().0.iter().map(|&word| u64::from_le_bytes(word)).collect();
            Self { words_each: descriptor_bytes / 8, words }
        })
    }

    /// Returns the number of descriptors.
    pub fn len(&self) -> usize {
        self.words.len().checked_div(self.words_each).unwrap_or(0)
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.words.is_empty()
    }

    /// Returns the number of 64-bit words in each.
    pub fn words_each(&self) -> usize {
        self.words_each
    }

    /// Returns the number of bits in each.
    pub fn bits(&self) -> u32 {
        64 * self.words_each as u32
    }

    /// One of them.
    #[inline(always)]
    pub fn get(&self, index: usize) -> &[u64] {
        &self.words[index * self.words_each..][..self.words_each]
    }
}

/// Descriptors by columns, to be compared with one at a time.
#[derive(Clone, Debug)]
pub struct Columns {
    words_each: usize,
    count: usize,
    /// Word 0 of all, then word 1 of all, and so on.
    words: Vec<u64>,
}

impl Columns {
    /// Lays out descriptors of `words_each` words.
    pub fn new<'a>(words_each: usize, descriptors: impl ExactSizeIterator<Item = &'a [u64]>) -> Self {
        let count = descriptors.len();
        let mut words = vec![0; words_each * count];
        for (row, descriptor) in descriptors.enumerate() {
            for (column, &word) in descriptor.iter().enumerate().take(words_each) {
                words[column * count + row] = word;
            }
        }
        Self { words_each, count, words }
    }

    /// Returns the number of descriptors.
    pub fn len(&self) -> usize {
        self.count
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// The distance of one descriptor to each, in their order. `distances` is made as long as needed.
    pub fn distances_to(&self, descriptor: &[u64], distances: &mut Vec<u16>) {
        distances.clear();
        distances.resize(self.count, 0);
        dispatch(Fill { columns: self, descriptor, distances });
    }

    /// [`Columns::distances_to`], inside a kernel; there are as many `distances` as descriptors.
    #[inline(always)]
    pub(crate) fn fill_distances<const POPCNT: bool>(&self, descriptor: &[u64], distances: &mut [u16]) {
        match self.words_each {
            4 => self.fill::<POPCNT, 4>(descriptor, distances),
            6 => self.fill::<POPCNT, 6>(descriptor, distances),
            8 => self.fill::<POPCNT, 8>(descriptor, distances),
            _ => self.add_word_by_word::<POPCNT>(descriptor, distances),
        }
    }

    #[inline(always)]
    fn fill<const POPCNT: bool, const N: usize>(&self, descriptor: &[u64], distances: &mut [u16]) {
        let count = distances.len();
        let one: [u64; N] = std::array::from_fn(|column| descriptor[column]);
        let columns: [&[u64]; N] = std::array::from_fn(|column| &self.words[column * self.count..][..count]);
        for (row, distance) in distances.iter_mut().enumerate() {
            let differing = std::array::from_fn(|column| one[column] ^ columns[column][row]);
            *distance = count_ones::<POPCNT, N>(differing) as u16;
        }
    }

    #[inline(always)]
    fn add_word_by_word<const POPCNT: bool>(&self, descriptor: &[u64], distances: &mut [u16]) {
        if self.count == 0 {
            return;
        }
        distances.fill(0);
        for (column, &word) in self.words.chunks_exact(self.count).zip(descriptor) {
            for (distance, other) in distances.iter_mut().zip(column) {
                *distance += count_ones::<POPCNT, 1>([word ^ other]) as u16;
            }
        }
    }
}

/// The distances of one descriptor to all.
struct Fill<'a> {
    columns: &'a Columns,
    descriptor: &'a [u64],
    distances: &'a mut [u16],
}

impl Kernel for Fill<'_> {
    type Output = ();

    #[inline(always)]
    fn run<const POPCNT: bool>(self) {
        self.columns.fill_distances::<POPCNT>(self.descriptor, self.distances);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::instruction_set::portable::portably;
    use proptest::prelude::*;

    fn plain(a: &[u64], b: &[u64]) -> u32 {
        a.iter().zip(b).map(|(a, b)| (a ^ b).count_ones()).sum()
    }

    /// Random descriptors, some of them all ones, where the counters are fullest.
    fn descriptors(words: usize) -> impl Strategy<Value = Vec<Vec<u64>>> {
        let word = prop_oneof![3 => any::<u64>(), 1 => Just(u64::MAX), 1 => Just(0)];
        let descriptor = prop_oneof![
            4 => prop::collection::vec(word, words),
            1 => Just(vec![u64::MAX; words]),
            1 => Just(vec![0; words]),
        ];
        prop::collection::vec(descriptor, 1..20)
    }

    proptest! {
        #[test]
        fn every_layout_counts_alike(all in (1..12usize).prop_flat_map(descriptors)) {
            let columns = Columns::new(all[0].len(), all.iter().map(Vec::as_slice));
            let mut distances = Vec::new();
            for one in &all {
                columns.distances_to(one, &mut distances);
                let expected: Vec<u32> = all.iter().map(|other| plain(one, other)).collect();
                prop_assert_eq!(distances.iter().map(|&d| u32::from(d)).collect::<Vec<_>>(), expected.clone());
                let mut portable = Vec::new();
                portably(|| columns.distances_to(one, &mut portable));
                prop_assert_eq!(&portable, &distances);
                prop_assert_eq!(all.iter().map(|other| distance(one, other)).collect::<Vec<_>>(), expected);
            }
        }
    }

    #[test]
    fn a_fixed_length_counts_to_the_full() {
        assert_eq!(distance_fixed(&[0; 4], &[u64::MAX; 4]), 256);
        assert_eq!(distance_fixed(&[0; 8], &[u64::MAX; 8]), 512);
        assert_eq!(distance_fixed(&[1, 2, 3], &[1, 2, 3]), 0);
    }

    #[test]
    fn only_whole_words_are_packed() {
        let packed = PackedDescriptors::from_bytes(16, &[1; 48]).expect("three descriptors");
        assert_eq!((packed.len(), packed.words_each(), packed.bits()), (3, 2, 128));
        assert_eq!(packed.get(2), [0x0101_0101_0101_0101; 2]);
        assert!(PackedDescriptors::from_bytes(12, &[1; 48]).is_none());
        assert!(PackedDescriptors::from_bytes(32, &[1; 48]).is_none());
        assert!(PackedDescriptors::from_bytes(0, &[]).is_none());
        assert!(PackedDescriptors::from_bytes(32, &[]).is_some_and(|none| none.is_empty()));
        assert_eq!(PackedDescriptors::default().len(), 0);
    }
}
