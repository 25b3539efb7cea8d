//! The binary form: the arrays of a vocabulary as they lie in memory, little endian.
//!
//! | bytes | what |
//! |---|---|
//! | 8 | `MAGIC` |
//! | 4 x 8 | `u32`: version, k, L, scoring (0), weighting (0), bytes of a descriptor, nodes, words |
//! | 32 | fingerprint |
//! | 8, 8 | checksum of the content; checksum of the header up to here |
//! | 8 x nodes | links: children `count << 32 | first`, or the word |
//! | 8 x words | weights, `f64` |
//! | 4 x nodes | numbers in the text form, filled up with zero to a multiple of 8 |
//! | nodes x descriptor | descriptors |
//!
//! The content is the last four, the nodes breadth first.

mod check;
mod checksum;
mod fault;
mod header;
mod read;
mod write;

pub use self::fault::BinaryFault;
pub(super) use self::header::MAGIC;
pub(super) use self::read::read;
pub(super) use self::write::write;

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests;
#[cfg(test)]
pub(super) use self::tests::mend;
