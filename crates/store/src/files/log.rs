//! The write-ahead log on disk: is every committed frame in it?
//!
//! SQLite reads a log up to the first frame that does not fit, and says nothing of the rest: so it forgets a write that a
//! crash has interrupted. Which frame is the last committed one, only the log's index (`-shm`) tells, which a killed
//! process leaves behind: a commit enters it once its frames are synced. Without an index that belongs to the log, a
//! shortened log cannot be told from a shorter one.

use std::fs::File;
use std::io::{self, BufReader, Read};
use std::path::Path;

use super::paths::{DatabaseFiles, LOG_HEADER_BYTES};
use crate::StoreError;

const HEADER_BYTES: usize = LOG_HEADER_BYTES as usize;
const FRAME_HEADER_BYTES: usize = 24;
/// One copy of the index's header; there are two, and then the number of frames that are in the database already.
const INDEX_HEADER_BYTES: usize = 48;
const INDEX_BYTES: usize = 2 * INDEX_HEADER_BYTES + 4;
/// The version of both formats.
const FORMAT: u32 = 3_007_000;
/// The magic number of a log with little-endian checksums; big-endian ones have the next number.
const MAGIC: u32 = 0x377f_0682;
/// How often an index that changes meanwhile is read again.
const READS_MAX: usize = 3;

/// What is known of a log.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LogFindings {
    /// Committed frames are missing.
    pub faults: Vec<String>,
    /// It cannot be told whether frames are missing.
    pub notes: Vec<String>,
}

/// Looks at the log beside a database without changing anything. Must come before SQLite opens the database: that
/// writes the index anew if no process has it open. And never in a process that has it open: closing the index here would
/// release the locks that SQLite holds on it (POSIX locks belong to the process).
pub(crate) fn look(files: &DatabaseFiles) -> Result<LogFindings, StoreError> {
    let mut findings = LogFindings::default();
    for _ in 0..READS_MAX {
        let index = Index::read(&files.shm()).map_err(|error| StoreError::file(&files.shm(), &error))?;
        let log = Log::read(&files.wal()).map_err(|error| StoreError::file(&files.wal(), &error))?;
        findings = compare(index.as_ref(), log.as_ref());
        // A running server may have begun the log anew meanwhile.
        let again = Index::read(&files.shm()).map_err(|error| StoreError::file(&files.shm(), &error))?;
        if findings.faults.is_empty() || again == index {
            return Ok(findings);
        }
    }
    findings.faults.clear();
    Ok(findings)
}

fn compare(index: Option<&Index>, log: Option<&Log>) -> LogFindings {
    let mut findings = LogFindings::default();
    let fault = |committed: u32, there: u32| {
        format!(
            "the write-ahead log holds {there} of {committed} committed frames: writes that were acknowledged are missing"
        )
    };
    match (index, log) {
        (Some(index), None) if index.is_needed() => findings.faults.push(fault(index.last_frame, 0)),
        (Some(index), Some(log)) if index.salts == log.salts => {
            let is_short = index.is_needed() && log.frames < index.last_frame;
            findings.faults.extend(is_short.then(|| fault(index.last_frame, log.frames)));
        }
        (_, Some(log)) if log.frames > 0 || log.rest.is_some() => {
            let index = "no index tells which frame of the write-ahead log is the last committed one";
            findings.notes.push(match log.rest {
                Some(rest) => format!("{index}; after frame {} {rest}", log.frames),
                None => format!("{index}; it holds {} that fit together", log.frames),
            });
        }
        _ => {}
    }
    findings
}

/// What the log's index says of the log.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Index {
    salts: [u8; 8],
    last_frame: u32,
    /// Number of frames that are synced in the database.
    backfilled: u32,
}

impl Index {
    /// Reads the header; `None` if there is none, or none that can be relied upon.
    fn read(path: &Path) -> io::Result<Option<Self>> {
        let Some(mut file) = opened(path)? else { return Ok(None) };
        let Some(bytes) = head(&mut file, INDEX_BYTES)? else { return Ok(None) };
        let (first, second) = bytes[..2 * INDEX_HEADER_BYTES].split_at(INDEX_HEADER_BYTES);
        let number = |at: usize| native(&bytes[at..at + 4]);
        let sum = checksum(&first[..40], [0, 0], native);
        let is_whole = first == second && sum == [number(40), number(44)];
        if !is_whole || number(0) != FORMAT || bytes[12] != 1 {
            return Ok(None);
        }
        let mut salts = [0; 8];
        salts.copy_from_slice(&bytes[32..40]);
        Ok(Some(Self { salts, last_frame: number(16), backfilled: number(2 * INDEX_HEADER_BYTES) }))
    }

    /// Whether the log holds frames that the database does not.
    fn is_needed(&self) -> bool {
        self.backfilled < self.last_frame
    }
}

/// What the log itself says.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Log {
    salts: [u8; 8],
    /// Frames that fit together, from the first.
    frames: u32,
    /// What comes after them and is no rest of an earlier log.
    rest: Option<&'static str>,
}

impl Log {
    /// Reads a log and verifies its frames; `None` if there is none.
    fn read(path: &Path) -> io::Result<Option<Self>> {
        // One handle for all of it: a process that closes the database removes the log.
        let Some(file) = opened(path)? else { return Ok(None) };
        let mut log = BufReader::with_capacity(1 << 20, file);
        let Some(header) = head(&mut log, HEADER_BYTES)? else { return Ok(None) };
        let mut salts = [0; 8];
        salts.copy_from_slice(&header[16..24]);
        let magic = big(&header[..4]);
        let word = if magic == MAGIC { little } else { big };
        let mut sum = checksum(&header[..24], [0, 0], word);
        let page_bytes = big(&header[8..12]) as usize;
        let is_header = (magic | 1) == (MAGIC | 1)
            && sum == [big(&header[24..28]), big(&header[28..32])]
            && page_bytes.is_power_of_two()
            && (512..=65_536).contains(&page_bytes);
        if !is_header {
            return Ok(Some(Self { salts, frames: 0, rest: Some("the header does not fit") }));
        }
        let mut frame = vec![0; FRAME_HEADER_BYTES + page_bytes];
        let mut frames = 0;
        let rest = loop {
            let read = fill(&mut log, &mut frame)?;
            if read < frame.len() {
                // Only what begins like a frame of this log; an earlier log may have been longer.
                let began = read >= 16 && frame[8..16] == salts;
                break began.then_some("the file ends within a frame");
            }
            if frame[8..16] != salts {
                break None;
            }
            sum = checksum(&frame[..8], sum, word);
            sum = checksum(&frame[FRAME_HEADER_BYTES..], sum, word);
            if sum != [big(&frame[16..20]), big(&frame[20..24])] {
                break Some(
                    "there is one that does not fit: of a write that did not come to its end, or damaged",
                );
            }
            frames += 1;
        };
        Ok(Some(Self { salts, frames, rest }))
    }
}

/// Opens a file; `None` if it is not there.
fn opened(path: &Path) -> io::Result<Option<File>> {
    match File::open(path) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
        opened => opened.map(Some),
    }
}

/// Returns the first bytes of a file; `None` if it is shorter.
fn head(file: &mut impl Read, bytes: usize) -> io::Result<Option<Vec<u8>>> {
    let mut head = vec![0; bytes];
    let read = fill(file, &mut head)?;
    Ok((read == bytes).then_some(head))
}

/// Reads as much as there is, and returns how much that was.
fn fill(from: &mut impl Read, buffer: &mut [u8]) -> io::Result<usize> {
    let mut filled = 0;
    while filled < buffer.len() {
        match from.read(&mut buffer[filled..])? {
            0 => break,
            read => filled += read,
        }
    }
    Ok(filled)
}

/// SQLite's checksum over pairs of 32-bit words, continued.
fn checksum(bytes: &[u8], [mut a, mut b]: [u32; 2], word: impl Fn(&[u8]) -> u32) -> [u32; 2] {
    for pair in bytes.chunks_exact(8) {
        a = a.wrapping_add(word(&pair[..4])).wrapping_add(b);
        b = b.wrapping_add(word(&pair[4..])).wrapping_add(a);
    }
    [a, b]
}

fn big(bytes: &[u8]) -> u32 {
    bytes.iter().fold(0, |number, byte| number << 8 | u32::from(*byte))
}

fn little(bytes: &[u8]) -> u32 {
    bytes.iter().rev().fold(0, |number, byte| number << 8 | u32::from(*byte))
}

fn native(bytes: &[u8]) -> u32 {
    if cfg!(target_endian = "little") { little(bytes) } else { big(bytes) }
}
