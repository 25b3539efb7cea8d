//! The header of the binary form.

use super::checksum::Checksum;
use super::fault::BinaryFault;
use crate::vocabulary::content::{VERSION, numbers};
use crate::vocabulary::fingerprint::Fingerprint;
use crate::vocabulary::shape::{NODES_MAX, Shape};
use crate::vocabulary::transform::pack;
use crate::vocabulary::tree::Tree;

/// First bytes of the binary form. The second is not text, so no text form begins with them.
pub(in crate::vocabulary) const MAGIC: [u8; 8] = *b"\x96RVOC\r\n\x1a";

/// What stands before the content.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Header {
    pub shape: Shape,
    pub nodes: usize,
    pub words: usize,
    pub fingerprint: Fingerprint,
    pub content_checksum: u64,
}

impl Header {
    pub const BYTES: usize = 8 + 8 * 4 + 32 + 8 + 8;

    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = MAGIC.to_vec();
        bytes.extend(numbers(self.shape, self.nodes, self.words));
        bytes.extend(self.fingerprint.as_bytes());
        bytes.extend(self.content_checksum.to_le_bytes());
        bytes.extend(sum(&bytes).to_le_bytes());
        bytes
    }

    pub fn from_bytes(bytes: &[u8; Self::BYTES]) -> Result<Self, BinaryFault> {
        let (covered, stored) = bytes.split_at(Self::BYTES - 8);
        if !bytes.starts_with(&MAGIC) {
            return Err(BinaryFault::Magic);
        }
        let number = |at: usize| bytes[8..].as_chunks::<4>().0.get(at).map_or(0, |n| u32::from_le_bytes(*n));
        if number(0) != VERSION {
            return Err(BinaryFault::Version(number(0)));
        }
        if sum(covered).to_le_bytes() != stored {
            return Err(BinaryFault::HeaderChecksum);
        }
        let (branching, levels) = Tree::check_shape(number(1).into(), number(2).into())?;
        let descriptor_bytes = number(5) as usize;
        let (nodes, words) = (number(6) as usize, number(7) as usize);
        let bound = |holds: bool, what, got: usize| {
            if holds { Ok(()) } else { Err(BinaryFault::Bounds { what, got: got as u64 }) }
        };
        bound(number(3) == 0, "the scoring (0 is L1)", number(3) as usize)?;
        bound(number(4) == 0, "the weighting (0 is TF-IDF)", number(4) as usize)?;
        bound(
            descriptor_bytes.is_multiple_of(8) && (8..=512).contains(&descriptor_bytes),
            "the length of a descriptor",
            descriptor_bytes,
        )?;
        bound((2..=NODES_MAX).contains(&nodes), "the number of nodes", nodes)?;
        bound((1..nodes).contains(&words), "the number of words", words)?;
        let mut fingerprint = [0; 32];
        fingerprint.copy_from_slice(&bytes[40..72]);
        Ok(Self {
            shape: Shape { branching, levels, descriptor_bytes },
            nodes,
            words,
            fingerprint: Fingerprint::from_bytes(fingerprint),
            content_checksum: pack(&bytes[72..80]).first().copied().unwrap_or_default(),
        })
    }
}

fn sum(bytes: &[u8]) -> u64 {
    let mut checksum = Checksum::new();
    checksum.add(&pack(bytes));
    checksum.finish()
}
