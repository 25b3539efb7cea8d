//! Reads the binary form: one pass, into the memory where it stays.

use std::io::{self, Read};

use super::check::Check;
use super::checksum::Checksum;
use super::fault::BinaryFault;
use super::header::Header;
use crate::vocabulary::arrays::Arrays;
use crate::vocabulary::content::BLOCK_WORDS;
use crate::vocabulary::error::VocabularyError;
use crate::vocabulary::flat_tree::Vocabulary;

/// Blocks that are read at a time: what has just been read is still in a near cache when it is summed up and checked.
const BLOCKS_READ: usize = 2;

/// Reads a vocabulary. Whatever the bytes are, what comes out has its children and words in place.
pub(in crate::vocabulary) fn read(bytes: &mut impl Read) -> Result<Vocabulary, VocabularyError> {
    let mut head = [0; Header::BYTES];
    bytes.read_exact(&mut head).map_err(cut_short)?;
    let header = Header::from_bytes(&head)?;
    let (nodes, each) = (header.nodes, header.shape.descriptor_bytes / 8);
    let mut arrays = Arrays::zeroed(nodes, header.words, each)
        .ok_or(BinaryFault::Memory { nodes, descriptor_bytes: 8 * each })?;

    let mut checksum = Checksum::new();
    let mut check = Check::new(nodes, header.words);
    let [links, weights, node_ids, descriptors] = arrays.parts_mut();
    read_array(bytes, links, &mut checksum, |block| check.links(block))?;
    read_array(bytes, weights, &mut checksum, |block| check.weights(block))?;
    read_array(bytes, node_ids, &mut checksum, |block| check.node_ids(block))?;
    read_array(bytes, descriptors, &mut checksum, |_| ())?;
    if !nodes.is_multiple_of(2)
        && let Some(last) = node_ids.last_mut()
    {
        // What fills up the last pair is no number; equal vocabularies have equal arrays.
        *last &= u64::from(u32::MAX);
    }

    if checksum.finish() != header.content_checksum {
        return Err(BinaryFault::Checksum.into());
    }
    if bytes.read(&mut [0])? != 0 {
        return Err(BinaryFault::TooLong.into());
    }
    check.finish()?;
    let Header { shape, fingerprint, .. } = header;
    Ok(Vocabulary { shape, arrays, fingerprint })
}

/// Reads an array, and calls `check` for each of its blocks.
fn read_array(
    bytes: &mut impl Read,
    array: &mut [u64],
    checksum: &mut Checksum,
    mut check: impl FnMut(&[u64]),
) -> Result<(), VocabularyError> {
    for piece in array.chunks_mut(BLOCKS_READ * BLOCK_WORDS) {
        bytes.read_exact(bytemuck::cast_slice_mut(piece)).map_err(cut_short)?;
        if cfg!(target_endian = "big") {
            for word in &mut *piece {
                *word = u64::from_le(*word);
            }
        }
        for block in piece.chunks(BLOCK_WORDS) {
            checksum.add(block);
            check(block);
        }
    }
    Ok(())
}

fn cut_short(error: io::Error) -> VocabularyError {
    if error.kind() == io::ErrorKind::UnexpectedEof { BinaryFault::CutShort.into() } else { error.into() }
}
