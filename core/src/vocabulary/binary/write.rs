//! Writes the binary form.

use std::io::{self, Write};

use super::BLOCK_WORDS;
use super::checksum::Checksum;
use super::header::Header;
use crate::vocabulary::Vocabulary;

/// Writes a vocabulary.
pub(in crate::vocabulary) fn write(vocabulary: &Vocabulary, mut out: impl Write) -> io::Result<()> {
    let mut checksum = Checksum::new();
    for_each_block(vocabulary, |block| {
        checksum.add(block);
        Ok(())
    })?;
    let header = Header {
        shape: vocabulary.shape(),
        nodes: vocabulary.node_count(),
        words: vocabulary.word_count(),
        fingerprint: vocabulary.fingerprint(),
        content_checksum: checksum.finish(),
    };
    out.write_all(&header.to_bytes())?;
    write_blocks(vocabulary, &mut out)?;
    out.flush()
}

/// Writes what the fingerprint covers: the header's numbers and the content.
pub(in crate::vocabulary) fn write_content(vocabulary: &Vocabulary, out: &mut impl Write) -> io::Result<()> {
    out.write_all(&Header::numbers(vocabulary.shape(), vocabulary.node_count(), vocabulary.word_count()))?;
    write_blocks(vocabulary, out)
}

fn write_blocks(vocabulary: &Vocabulary, out: &mut impl Write) -> io::Result<()> {
    let mut bytes = Vec::with_capacity(BLOCK_WORDS * 8);
    for_each_block(vocabulary, |block| {
        bytes.clear();
        bytes.extend(block.iter().flat_map(|word| word.to_le_bytes()));
        out.write_all(&bytes)
    })
}

fn for_each_block(vocabulary: &Vocabulary, mut each: impl FnMut(&[u64]) -> io::Result<()>) -> io::Result<()> {
    section(vocabulary.links.iter().map(|link| link.bits()), &mut each)?;
    section(vocabulary.weights.iter().map(|weight| weight.to_bits()), &mut each)?;
    let pairs = vocabulary.node_ids.chunks(2).map(|pair| {
        let second = pair.get(1).copied().unwrap_or_default();
        u64::from(second) << 32 | u64::from(pair[0])
    });
    section(pairs, &mut each)?;
    section(vocabulary.descriptors.iter().copied(), &mut each)
}

fn section(
    mut words: impl Iterator<Item = u64>,
    each: &mut impl FnMut(&[u64]) -> io::Result<()>,
) -> io::Result<()> {
    let mut block = Vec::with_capacity(BLOCK_WORDS);
    loop {
        block.clear();
        block.extend(words.by_ref().take(BLOCK_WORDS));
        if block.is_empty() {
            return Ok(());
        }
        each(&block)?;
    }
}
