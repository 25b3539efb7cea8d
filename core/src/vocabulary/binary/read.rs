//! Reads the binary form: one pass, one allocation an array.

use std::io::{self, Read};

use super::checksum::Checksum;
use super::fault::BinaryFault;
use super::header::Header;
use crate::vocabulary::content::BLOCK_WORDS;
use crate::vocabulary::error::VocabularyError;
use crate::vocabulary::flat_tree::Vocabulary;
use crate::vocabulary::link::Link;
use crate::vocabulary::tree;

/// Reads a vocabulary. Whatever the bytes are, what comes out has its children and words in place.
pub(in crate::vocabulary) fn read(bytes: &mut impl Read) -> Result<Vocabulary, VocabularyError> {
    let mut head = [0; Header::BYTES];
    bytes.read_exact(&mut head).map_err(cut_short)?;
    let header = Header::from_bytes(&head)?;
    let mut content =
        Content { bytes, checksum: Checksum::new(), buffer: vec![0; BLOCK_WORDS * 8], block: Vec::new() };
    let (nodes, each) = (header.nodes, header.shape.descriptor_bytes / 8);

    let links = content.section(nodes, nodes, |out, block| {
        out.extend(block.iter().map(|&bits| Link::from_bits(bits)));
    })?;
    let weights = content.section(header.words, header.words, |out, block| {
        out.extend(block.iter().map(|&bits| f64::from_bits(bits)));
    })?;
    let mut node_ids = content.section(nodes.div_ceil(2), nodes.next_multiple_of(2), |out, block| {
        out.extend(block.iter().flat_map(|&pair| [pair as u32, (pair >> 32) as u32]));
    })?;
    node_ids.truncate(nodes);
    let descriptors = content.section(nodes * each, nodes * each, Vec::extend_from_slice)?;

    if content.checksum.finish() != header.content_checksum {
        return Err(BinaryFault::Checksum.into());
    }
    if bytes.read(&mut [0])? != 0 {
        return Err(BinaryFault::TooLong.into());
    }
    check(&links, &node_ids, &weights)?;
    let Header { shape, fingerprint, .. } = header;
    Ok(Vocabulary { shape, links, node_ids, weights, descriptors, fingerprint })
}

/// The content still to be read, and the checksum of what has been.
struct Content<'a, R> {
    bytes: &'a mut R,
    checksum: Checksum,
    buffer: Vec<u8>,
    block: Vec<u64>,
}

impl<R: Read> Content<'_, R> {
    /// Reads `words` 64-bit words into an array with room for `items`, block by block: what has just been
    /// read is still in the cache when it is summed up and put in its place.
    fn section<T>(
        &mut self,
        words: usize,
        items: usize,
        put: impl Fn(&mut Vec<T>, &[u64]),
    ) -> Result<Vec<T>, VocabularyError> {
        let mut out = Vec::new();
        out.try_reserve_exact(items).map_err(|_| BinaryFault::Memory(items * size_of::<T>()))?;
        let mut left = words;
        while left > 0 {
            let count = left.min(BLOCK_WORDS);
            let buffer = &mut self.buffer[..count * 8];
            self.bytes.read_exact(buffer).map_err(cut_short)?;
            self.block.clear();
            self.block.extend(buffer.as_chunks::<8>().0.iter().map(|word| u64::from_le_bytes(*word)));
            self.checksum.add(&self.block);
            put(&mut out, &self.block);
            left -= count;
        }
        Ok(out)
    }
}

/// Breadth first means: the children of each node begin where those of the node before it ended. With every
/// child after its parent there is no cycle, and every descent ends at a word.
fn check(links: &[Link], node_ids: &[u32], weights: &[f64]) -> Result<(), BinaryFault> {
    let (nodes, words) = (links.len() as u64, weights.len() as u64);
    let mut next = 1;
    let mut words_seen = 0;
    for (node, (link, &id)) in (0..).zip(links.iter().zip(node_ids)) {
        let (target, count) = (u64::from(link.target()), u64::from(link.count()));
        let in_place = if count == 0 {
            words_seen += 1;
            target < words
        } else {
            target == next && next > node
        };
        next += count;
        if !in_place || next > nodes || u64::from(id) >= nodes {
            return Err(BinaryFault::Link(node as u32));
        }
    }
    if next != nodes || words_seen != words || links[0].count() == 0 {
        return Err(BinaryFault::Link(0));
    }
    (0..).zip(weights).try_for_each(|(word, &weight)| Ok(tree::check_weight(word, weight)?))
}

fn cut_short(error: io::Error) -> VocabularyError {
    if error.kind() == io::ErrorKind::UnexpectedEof { BinaryFault::CutShort.into() } else { error.into() }
}
