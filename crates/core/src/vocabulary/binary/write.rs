//! Writes the binary form.

use std::io::{self, Write};

use super::checksum::Checksum;
use super::header::Header;
use crate::vocabulary::content::{for_each_block, write_blocks};
use crate::vocabulary::flat_tree::Vocabulary;

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
