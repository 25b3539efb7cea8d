//! The content of a vocabulary as bytes: held by the binary form, covered by the fingerprint.

use std::io::{self, Write};

use sha2::{Digest, Sha256};

use super::fingerprint::Fingerprint;
use super::flat_tree::Vocabulary;
use super::shape::Shape;

/// Version of the layout, the only one.
pub(super) const VERSION: u32 = 1;

/// 64-bit words that are summed up and read at a time; each array begins a new block.
pub(super) const BLOCK_WORDS: usize = 16 * 1024;

impl Vocabulary {
    /// Computes the fingerprint of the content.
    pub(super) fn content_fingerprint(&self) -> Fingerprint {
        let mut hasher = Hasher(Sha256::new());
        // Writing to a hasher does not fail.
        let _ = hasher.write_all(&numbers(self.shape, self.node_count(), self.word_count()));
        let _ = write_blocks(self, &mut hasher);
        Fingerprint::from_bytes(hasher.0.finalize().into())
    }

    /// Whether the content is what its fingerprint says. The binary form carries the fingerprint along, and
    /// loading it verifies a faster checksum only.
    pub fn fingerprint_holds(&self) -> bool {
        self.fingerprint == self.content_fingerprint()
    }
}

/// Returns the numbers of the binary form's header; the fingerprint covers them too.
pub(super) fn numbers(shape: Shape, nodes: usize, words: usize) -> [u8; 32] {
    let bytes = shape.descriptor_bytes as u32;
    let numbers = [VERSION, shape.branching, shape.levels, 0, 0, bytes, nodes as u32, words as u32];
    let mut all = [0; 32];
    for (slot, number) in all.as_chunks_mut::<4>().0.iter_mut().zip(numbers) {
        *slot = number.to_le_bytes();
    }
    all
}

/// Writes the arrays, block by block.
pub(super) fn write_blocks(vocabulary: &Vocabulary, out: &mut impl Write) -> io::Result<()> {
    let mut bytes = Vec::with_capacity(BLOCK_WORDS * 8);
    for_each_block(vocabulary, |block| {
        bytes.clear();
        bytes.extend(block.iter().flat_map(|word| word.to_le_bytes()));
        out.write_all(&bytes)
    })
}

/// Calls `each` with the arrays' 64-bit words, block by block; each array begins a new block.
pub(super) fn for_each_block(
    vocabulary: &Vocabulary,
    mut each: impl FnMut(&[u64]) -> io::Result<()>,
) -> io::Result<()> {
    vocabulary
        .arrays
        .parts()
        .in_order()
        .into_iter()
        .flat_map(|array| array.chunks(BLOCK_WORDS))
        .try_for_each(&mut each)
}

struct Hasher(Sha256);

impl Write for Hasher {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.update(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
