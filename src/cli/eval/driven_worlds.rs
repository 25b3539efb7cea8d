//! Driven worlds: each result is written when its run ends, so that a stopped run can be resumed.
//!
//! The first line of `worlds.ndjson` identifies the program by its SHA-256, so that results of two methods are not
//! mixed. Each further line is one world.

use std::collections::{HashMap, HashSet};
use std::fs::{self, File};
use std::io::Write as _;
use std::path::Path;
use std::sync::Mutex;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde::{Deserialize, Serialize};
use sha2::{Digest as _, Sha256};
use tempfile::NamedTempFile;

use crate::cli::failure::Failure;
use crate::hotel::scoring::results::WorldResult;
use crate::hotel::sensing::noise::NoiseKind;

const FILE: &str = "worlds.ndjson";

/// The header line.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
struct Begin {
    program: String,
}

/// The worlds completed so far.
pub(super) struct DrivenWorlds {
    before: Vec<WorldResult>,
    file: Mutex<File>,
}

impl DrivenWorlds {
    /// Starts a run in a folder, or resumes the existing one.
    pub fn open(folder: &Path, resume: bool) -> Result<Self, Failure> {
        fs::create_dir_all(folder)?;
        Self::open_by(folder, resume, &this_program()?)
    }

    fn open_by(folder: &Path, resume: bool, program: &str) -> Result<Self, Failure> {
        let path = folder.join(FILE);
        let begin = Begin { program: program.to_owned() };
        let before = if resume { read(&path, &begin)? } else { Vec::new() };
        if !resume && path.exists() {
            // Keep an earlier run: a repeated command must not discard hours of results.
            fs::rename(&path, folder.join(format!("{FILE}.old")))?;
        }
        // Rewritten, because the last line of a stopped run may be incomplete.
        let mut text = line(&begin)?;
        for result in &before {
            text.push_str(&line(result)?);
        }
        let mut beside = NamedTempFile::new_in(folder)?;
        beside.write_all(text.as_bytes())?;
        let file = beside.persist(&path)?;
        Ok(Self { before, file: Mutex::new(file) })
    }

    /// Returns the worlds of a list that are not yet completed.
    pub fn left(&self, worlds: &[(NoiseKind, u64)]) -> Vec<(NoiseKind, u64)> {
        let driven: HashSet<(NoiseKind, u64)> = self.before.iter().map(key).collect();
        worlds.iter().copied().filter(|world| !driven.contains(world)).collect()
    }

    /// Stores a result.
    pub fn keep(&self, result: &WorldResult) -> Result<(), Failure> {
        let line = line(result)?;
        let mut file = self.file.lock().map_err(|_| "an earlier result was not stored")?;
        Ok(file.write_all(line.as_bytes())?)
    }

    /// Returns the results of a list in its order, resumed and new ones.
    pub fn all(self, now: Vec<WorldResult>, worlds: &[(NoiseKind, u64)]) -> Vec<WorldResult> {
        let mut results = self.before;
        results.extend(now);
        let places: HashMap<_, usize> = worlds.iter().copied().zip(0..).collect();
        results.retain(|result| places.contains_key(&key(result)));
        results.sort_by_key(|result| places.get(&key(result)));
        results
    }
}

fn key(result: &WorldResult) -> (NoiseKind, u64) {
    (result.noise, result.seed)
}

fn line(value: &impl Serialize) -> Result<String, Failure> {
    Ok(format!("{}\n", serde_json::to_string(value)?))
}

fn read(path: &Path, begin: &Begin) -> Result<Vec<WorldResult>, Failure> {
    let text = fs::read_to_string(path).map_err(|error| format!("{}: {error}", path.display()))?;
    // Text after the last line break was not completely written.
    let whole = text.rfind('\n').map_or("", |end| &text[..end]);
    let mut lines = whole.lines();
    let begun: Begin = serde_json::from_str(lines.next().unwrap_or_default())
        .map_err(|error| format!("{}, line 1: {error}", path.display()))?;
    if begun != *begin {
        return Err(format!("{} was started by another build of this program", path.display()).into());
    }
    let parse = |(number, line): (usize, &str)| {
        serde_json::from_str(line)
            .map_err(|error| format!("{}, line {}: {error}", path.display(), number + 2))
    };
    Ok(lines.enumerate().map(parse).collect::<Result<_, _>>()?)
}

fn this_program() -> Result<String, Failure> {
    // With /proc, the running program itself, even if a build has replaced its file since.
    let running = fs::read("/proc/self/exe").or_else(|_| fs::read(std::env::current_exe()?))?;
    Ok(STANDARD.encode(Sha256::digest(running)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn result(seed: u64) -> WorldResult {
        WorldResult {
            noise: NoiseKind::Mixed,
            seed,
            keyframes: 7,
            arms: Vec::new(),
            fleet: None,
            rounds: Vec::new(),
            signs: None,
        }
    }

    #[test]
    fn a_run_that_was_stopped_within_a_line_goes_on_after_the_last_whole_one() {
        let folder = tempfile::tempdir().unwrap();
        let first = DrivenWorlds::open_by(folder.path(), false, "a").unwrap();
        first.keep(&result(3)).unwrap();
        first.file.lock().unwrap().write_all(b"{\"noise\":\"mix").unwrap();
        let worlds: Vec<_> = (1..=3).map(|seed| (NoiseKind::Mixed, seed)).collect();
        let second = DrivenWorlds::open_by(folder.path(), true, "a").unwrap();
        let left = second.left(&worlds);
        assert_eq!(left, [(NoiseKind::Mixed, 1), (NoiseKind::Mixed, 2)]);
        second.keep(&result(2)).unwrap();
        let third = DrivenWorlds::open_by(folder.path(), true, "a").unwrap();
        assert_eq!(third.left(&worlds), [(NoiseKind::Mixed, 1)]);
        let seeds: Vec<u64> = third.all(vec![result(1)], &worlds).iter().map(|result| result.seed).collect();
        assert_eq!(seeds, [1, 2, 3], "in the order of the list");
    }

    #[test]
    fn figures_of_another_build_are_refused_and_a_run_that_is_not_resumed_begins_anew() {
        let folder = tempfile::tempdir().unwrap();
        DrivenWorlds::open_by(folder.path(), false, "a").unwrap().keep(&result(1)).unwrap();
        let refused = DrivenWorlds::open_by(folder.path(), true, "b").err().unwrap().to_string();
        assert!(refused.contains("another build"), "{refused}");
        assert_eq!(DrivenWorlds::open_by(folder.path(), false, "b").unwrap().before.len(), 0);
        assert!(fs::read_to_string(folder.path().join("worlds.ndjson.old")).unwrap().contains("mixed"));
        let none = DrivenWorlds::open_by(&folder.path().join("none"), true, "b").err().unwrap().to_string();
        assert!(none.contains("worlds.ndjson"), "{none}");
    }
}
