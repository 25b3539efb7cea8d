//! One line of the text form, parsed by hand: a large vocabulary has a million of them, and forty million numbers.

use super::fault::TextFault;
use crate::vocabulary::shape::DESCRIPTOR_BYTES_MAX;

/// A node without its descriptor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct NodeLine {
    pub parent: u64,
    pub is_word: bool,
    pub weight: f64,
}

/// Reads the header: k, L, scoring, weighting.
pub(super) fn header(line: &[u8]) -> Result<[u64; 4], TextFault> {
    let mut rest = line;
    let mut numbers = [0; 4];
    for number in &mut numbers {
        *number = whole(&mut rest).ok_or(TextFault::Header)?;
    }
    if rest.trim_ascii_start().is_empty() { Ok(numbers) } else { Err(TextFault::Header) }
}

/// Returns how many bytes the descriptor on a line has.
pub(super) fn descriptor_bytes(line: &[u8]) -> Result<usize, TextFault> {
    let bytes = byte_count(line).ok_or(TextFault::Node("there are fewer than four numbers"))?;
    if bytes > 0 && bytes.is_multiple_of(8) && bytes <= DESCRIPTOR_BYTES_MAX {
        Ok(bytes)
    } else {
        Err(TextFault::DescriptorBytes(bytes))
    }
}

/// Reads a node whose descriptor has `expected` bytes, and adds the descriptor to `descriptors`.
pub(super) fn node(line: &[u8], expected: usize, descriptors: &mut Vec<u64>) -> Result<NodeLine, TextFault> {
    parse(line, expected, descriptors).map_err(|what| match byte_count(line) {
        Some(got) if got != expected => TextFault::MixedDescriptors { got, expected },
        _ => TextFault::Node(what),
    })
}

fn parse(line: &[u8], expected: usize, descriptors: &mut Vec<u64>) -> Result<NodeLine, &'static str> {
    let mut rest = line;
    let parent = whole(&mut rest).ok_or("the parent is not a whole number")?;
    let is_word = match whole(&mut rest) {
        Some(0) => false,
        Some(1) => true,
        _ => return Err("isLeaf is neither 0 nor 1"),
    };
    for _ in 0..expected / 8 {
        let mut word = [0; 8];
        for byte in &mut word {
            *byte = whole(&mut rest)
                .and_then(|value| u8::try_from(value).ok())
                .ok_or("a byte of the descriptor is not a whole number from 0 to 255")?;
        }
        descriptors.push(u64::from_le_bytes(word));
    }
    let weight = rest.trim_ascii();
    let weight = str::from_utf8(weight).ok().and_then(|weight| weight.parse().ok());
    Ok(NodeLine { parent, is_word, weight: weight.ok_or("the weight is not one number")? })
}

/// Takes the next whole number off the front.
fn whole(rest: &mut &[u8]) -> Option<u64> {
    let mut bytes = *rest;
    while let [b' ' | b'\t', after @ ..] = bytes {
        bytes = after;
    }
    let mut value: u64 = 0;
    let mut digits = 0;
    while let [digit @ b'0'..=b'9', after @ ..] = bytes {
        // Digits too many are refused below, whatever they would make.
        value = value.wrapping_mul(10).wrapping_add(u64::from(digit - b'0'));
        digits += 1_u64;
        bytes = after;
    }
    let ends = bytes.first().is_none_or(u8::is_ascii_whitespace);
    *rest = bytes;
    // 18 digits fit a u64, whatever they are.
    (ends && (1..=18).contains(&digits)).then_some(value)
}

/// Numbers on a line, less parent, isLeaf and weight.
fn byte_count(line: &[u8]) -> Option<usize> {
    let numbers = line.split(u8::is_ascii_whitespace).filter(|number| !number.is_empty());
    numbers.count().checked_sub(3)
}
