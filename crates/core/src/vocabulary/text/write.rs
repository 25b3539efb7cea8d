//! Writes the text form; every weight in as many digits as it takes to read the same double.

use std::io::{self, BufWriter, Write};

use crate::vocabulary::flat_tree::Vocabulary;

/// Writes a vocabulary, its nodes in the order of the file it came from.
pub(in crate::vocabulary) fn write(vocabulary: &Vocabulary, out: impl Write) -> io::Result<()> {
    let mut out = BufWriter::with_capacity(256 * 1024, out);
    let shape = vocabulary.shape();
    write!(out, "{} {}  0 0", shape.branching, shape.levels)?;
    let nodes = in_file_order(vocabulary);
    let decimals: Vec<String> = (0..=255).map(|byte: u8| format!("{byte} ")).collect();
    let each = vocabulary.descriptor_words();
    let parts = vocabulary.arrays.parts();
    for &(node, parent) in nodes.iter().skip(1) {
        let (node, link) = (node as usize, parts.link(node));
        let is_word = link.count() == 0;
        write!(out, "\n{} {} ", parts.node_id(parent), u8::from(is_word))?;
        for word in &parts.descriptors[node * each..(node + 1) * each] {
            for byte in word.to_le_bytes() {
                out.write_all(decimals[usize::from(byte)].as_bytes())?;
            }
        }
        let weight = if is_word { parts.weight(link.target()) } else { 0.0 };
        write!(out, " {weight}")?;
    }
    out.flush()
}

/// Each node and its parent, by their number in the file.
fn in_file_order(vocabulary: &Vocabulary) -> Vec<(u32, u32)> {
    let mut nodes = vec![(0, 0); vocabulary.node_count()];
    let parts = vocabulary.arrays.parts();
    for node in 0..vocabulary.node_count() as u32 {
        let link = parts.link(node);
        for child in link.target()..link.target() + link.count() {
            nodes[parts.node_id(child) as usize] = (child, node);
        }
    }
    nodes
}
