//! The fingerprint: SHA-256 over a vocabulary's content, whatever form it was read from.

use std::fmt;
use std::io::{self, Write};

use sha2::{Digest, Sha256};

use super::{Vocabulary, binary};

/// The name of a vocabulary's content: two vocabularies with one fingerprint make the same words.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Fingerprint([u8; 32]);

impl Fingerprint {
    /// Returns a fingerprint kept as bytes.
    pub const fn from_bytes(bytes: [u8; 32]) -> Self {
        Self(bytes)
    }

    /// Its bytes.
    pub const fn as_bytes(&self) -> &[u8; 32] {
        &self.0
    }

    /// Takes it of the content: what the binary form holds, without its own checks.
    pub(super) fn of(vocabulary: &Vocabulary) -> Self {
        let mut hasher = Hasher(Sha256::new());
        // Writing to a hasher does not fail.
        let _ = binary::write_content(vocabulary, &mut hasher);
        Self(hasher.0.finalize().into())
    }
}

impl fmt::Display for Fingerprint {
    /// In hexadecimal, as `sha256sum` prints it.
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|byte| write!(formatter, "{byte:02x}"))
    }
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
