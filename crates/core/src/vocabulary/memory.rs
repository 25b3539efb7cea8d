//! Memory for a vocabulary: 64-bit words, on huge pages where the system grants them.
//!
//! A million words take 57 MB. Memory comes from the kernel in pages of 4 KB, each handed out when it is first touched:
//! 14,000 times, which takes longer than reading the file. Pages of 2 MB are handed out 28 times, and the descent, which
//! jumps all over them, waits for fewer entries of the page table.

use std::ops::{Deref, DerefMut};

use memmap2::MmapMut;

/// Less memory than this is on the heap: two huge pages.
const MAPPED_MIN_BYTES: usize = 4 << 20;

/// Some 64-bit words.
pub(super) enum Words {
    /// On the heap.
    Heap(Vec<u64>),
    /// From the kernel; the start of a page, its length a multiple of 8.
    Mapped(MmapMut),
}

impl Words {
    /// Returns this many zeros; `None` if there is no memory for them.
    pub fn zeroed(count: usize) -> Option<Self> {
        let bytes = count.checked_mul(8)?;
        if bytes >= MAPPED_MIN_BYTES
            && let Ok(mapped) = MmapMut::map_anon(bytes)
        {
            // Advice, which a system without huge pages does not take.
            #[cfg(target_os = "linux")]
            let _ = mapped.advise(memmap2::Advice::HugePage);
            return Some(Self::Mapped(mapped));
        }
        let mut words = Vec::new();
        words.try_reserve_exact(count).ok()?;
        words.resize(count, 0);
        Some(Self::Heap(words))
    }
}

impl Deref for Words {
    type Target = [u64];

    fn deref(&self) -> &[u64] {
        match self {
            Self::Heap(words) => words,
            Self::Mapped(bytes) => bytemuck::cast_slice(bytes),
        }
    }
}

impl DerefMut for Words {
    fn deref_mut(&mut self) -> &mut [u64] {
        match self {
            Self::Heap(words) => words,
            Self::Mapped(bytes) => bytemuck::cast_slice_mut(bytes),
        }
    }
}

impl Clone for Words {
    fn clone(&self) -> Self {
        match Self::zeroed(self.len()) {
            Some(mut words) => {
                words.copy_from_slice(self);
                words
            }
            None => Self::Heap(self.to_vec()),
        }
    }
}

impl PartialEq for Words {
    fn eq(&self, other: &Self) -> bool {
        **self == **other
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_zero_and_can_be_written_whatever_memory_they_are_in() {
        for count in [0, 1, 1000, MAPPED_MIN_BYTES / 8, MAPPED_MIN_BYTES / 8 + 3] {
            let mut words = Words::zeroed(count).expect("a few megabytes");
            assert_eq!(words.len(), count);
            assert!(words.iter().all(|word| *word == 0));
            words.iter_mut().zip(1..).for_each(|(word, number)| *word = number);
            let copy = words.clone();
            assert!(copy == words && copy.last().copied().unwrap_or_default() == count as u64);
        }
        assert!(Words::zeroed(usize::MAX).is_none() && Words::zeroed(usize::MAX / 8).is_none());
    }
}
