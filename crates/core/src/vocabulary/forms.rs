//! The two forms of a vocabulary, read and written by one name.

use std::fs::File;
use std::io::{self, BufRead, Read, Write};
use std::path::Path;

use super::error::VocabularyError;
use super::flat_tree::Vocabulary;
use super::{binary, source, text};

impl Vocabulary {
    /// Loads a vocabulary in either form, plain or compressed.
    pub fn load(path: &Path) -> Result<Self, VocabularyError> {
        Self::read(File::open(path)?)
    }

    /// Reads a vocabulary in either form, plain or compressed, told by the first bytes.
    pub fn read(bytes: impl Read + Send + 'static) -> Result<Self, VocabularyError> {
        let (mut reader, is_binary) = source::open(bytes, &binary::MAGIC)?;
        if is_binary { binary::read(&mut reader) } else { text::read(&mut reader) }
    }

    /// Reads DBoW2's text form.
    pub fn read_text(mut text: impl BufRead) -> Result<Self, VocabularyError> {
        text::read(&mut text)
    }

    /// Reads the binary form.
    pub fn read_binary(mut bytes: impl Read) -> Result<Self, VocabularyError> {
        binary::read(&mut bytes)
    }

    /// Writes DBoW2's text form. It ends without a newline: some readers of that form take a blank last line for a word.
    pub fn write_text(&self, out: impl Write) -> io::Result<()> {
        text::write(self, out)
    }

    /// Writes the binary form.
    pub fn write_binary(&self, out: impl Write) -> io::Result<()> {
        binary::write(self, out)
    }
}
