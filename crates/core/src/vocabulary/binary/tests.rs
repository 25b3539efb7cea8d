//! Damage with matching checksums: only the checks behind them are left to find it.

use super::checksum::Checksum;
use super::header::Header;
use super::read::read;
use super::write::write;
use crate::vocabulary::content::BLOCK_WORDS;
use crate::vocabulary::transform::pack;

/// Makes the checksums right again, as far as the bytes go.
pub(in crate::vocabulary) fn mend(bytes: &mut [u8]) {
    let Some(head) = bytes.first_chunk::<{ Header::BYTES }>() else { return };
    let number =
        |at: usize| u32::from_le_bytes([head[at], head[at + 1], head[at + 2], head[at + 3]]) as usize;
    let (each, nodes, words) = (number(28), number(32), number(36));
    let mut checksum = Checksum::new();
    let mut content = pack(&bytes[Header::BYTES..]);
    for section in [nodes, words, nodes.div_ceil(2), nodes.saturating_mul(each / 8)] {
        let section: Vec<u64> = content.drain(..section.min(content.len())).collect();
        section.chunks(BLOCK_WORDS).for_each(|block| checksum.add(block));
    }
    bytes[72..80].copy_from_slice(&checksum.finish().to_le_bytes());
    let mut checksum = Checksum::new();
    checksum.add(&pack(&bytes[..Header::BYTES - 8]));
    bytes[Header::BYTES - 8..Header::BYTES].copy_from_slice(&checksum.finish().to_le_bytes());
}

#[test]
fn children_and_words_out_of_place_are_found_behind_right_checksums() {
    let node = |parent, is_word| format!("\n{parent} {is_word} 1 2 3 4 5 6 7 8 1");
    let text = format!("2 2  0 0{}{}{}", node(0, 0), node(0, 1), node(1, 1));
    let vocabulary = crate::vocabulary::Vocabulary::read_text(text.as_bytes()).unwrap();
    let mut bytes = Vec::new();
    write(&vocabulary, &mut bytes).unwrap();
    let mut unharmed = bytes.clone();
    mend(&mut unharmed);
    assert_eq!(unharmed, bytes);

    let links = Header::BYTES;
    // The root's first child, its number of children; a leaf's word; a node's number; a weight's sign.
    for (at, to) in [(0, 0), (4, 1), (4, 3), (4, 0), (16, 2), (24, 9), (56, 4)] {
        let mut damaged = bytes.clone();
        damaged[links + at] = to;
        mend(&mut damaged);
        let error = read(&mut damaged.as_slice()).unwrap_err().to_string();
        assert!(error.contains("where they belong"), "{at}: {error}");
    }
    let mut negative = bytes.clone();
    negative[links + 39] |= 0x80;
    mend(&mut negative);
    let error = read(&mut negative.as_slice()).unwrap_err().to_string();
    assert!(error.contains("must be finite and not negative"), "{error}");
}
