//! Reads the text form line by line, never held whole in memory.

use std::io::{BufRead, Read as _};

use super::fault::TextFault;
use super::line::{self, NodeLine};
use crate::vocabulary::error::VocabularyError;
use crate::vocabulary::flat_tree::Vocabulary;
use crate::vocabulary::shape::Shape;
use crate::vocabulary::tree::Tree;
use crate::vocabulary::tree_fault::TreeFault;

/// Ample for the longest descriptor, whatever blanks are between its numbers.
const LINE_BYTES_MAX: usize = 16 * 1024;

/// Reads a vocabulary. A final newline may be there or not; blank lines at the end are no words.
pub(in crate::vocabulary) fn read(text: &mut impl BufRead) -> Result<Vocabulary, VocabularyError> {
    let mut lines = Lines { text, line: Vec::new(), number: 0 };
    let (branching, levels) = {
        let header = lines.next()?.unwrap_or_default();
        // A byte order mark, as Windows writes it, is no part of the text.
        shape(header.strip_prefix(b"\xef\xbb\xbf").unwrap_or(header)).map_err(|fault| lines.wrong(fault))?
    };
    let mut tree: Option<Tree> = None;
    let mut descriptor_bytes = 0;
    while let Some(content) = lines.next()? {
        if content.is_empty() {
            let blank = lines.number;
            while let Some(more) = lines.next()? {
                if !more.is_empty() {
                    return Err(VocabularyError::Text { line: blank, fault: TextFault::Blank });
                }
            }
            break;
        }
        let added = match &mut tree {
            Some(tree) => add(tree, content, descriptor_bytes),
            None => line::descriptor_bytes(content).and_then(|bytes| {
                descriptor_bytes = bytes;
                let shape = Shape { branching, levels, descriptor_bytes };
                add(tree.insert(Tree::new(shape)), content, bytes)
            }),
        };
        added.map_err(|fault| lines.wrong(fault))?;
    }
    let tree = tree.ok_or(TreeFault::Empty)?;
    Ok(tree.finish()?)
}

fn shape(header: &[u8]) -> Result<(u32, u32), TextFault> {
    let [branching, levels, scoring, weighting] = line::header(header)?;
    let shape = Tree::check_shape(branching, levels)?;
    match (scoring, weighting) {
        (0, 0) => Ok(shape),
        (0, weighting) => Err(TextFault::Weighting(weighting)),
        (scoring, _) => Err(TextFault::Scoring(scoring)),
    }
}

fn add(tree: &mut Tree, content: &[u8], descriptor_bytes: usize) -> Result<(), TextFault> {
    let NodeLine { parent, is_word, weight } = line::node(content, descriptor_bytes, tree.descriptors())?;
    tree.push(parent, is_word, weight)?;
    Ok(())
}

/// Lines without the blanks around them, the one in hand and its number.
struct Lines<'a, R> {
    text: &'a mut R,
    line: Vec<u8>,
    number: u64,
}

impl<R: BufRead> Lines<'_, R> {
    fn next(&mut self) -> Result<Option<&[u8]>, VocabularyError> {
        self.line.clear();
        self.number += 1;
        // Beyond the longest line one byte more, and its newline.
        let mut bounded = self.text.take(LINE_BYTES_MAX as u64 + 2);
        if bounded.read_until(b'\n', &mut self.line)? == 0 {
            return Ok(None);
        }
        if self.line.strip_suffix(b"\n").unwrap_or(&self.line).len() > LINE_BYTES_MAX {
            return Err(self.wrong(TextFault::TooLong(LINE_BYTES_MAX)));
        }
        Ok(Some(self.line.trim_ascii()))
    }

    fn wrong(&self, fault: TextFault) -> VocabularyError {
        VocabularyError::Text { line: self.number, fault }
    }
}
