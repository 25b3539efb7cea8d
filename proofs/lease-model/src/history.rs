//! Histories of a map's writes and reads, judged by stateright's search over every order of their operations.
//!
//! `proofs/lib/linearizable.py` judges whole histories by the versions that they name. This is a second opinion on short parts of
//! them: it knows of a map only that each write makes the next version and that a read returns the newest.

use std::fmt;
use std::str::FromStr;

use stateright::semantics::{ConsistencyTester as _, LinearizabilityTester, SequentialSpec};

/// A map, as far as its version says what was done to it.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
struct Map {
    version: u64,
}

/// Request of a client.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Kind {
    /// One change.
    Write,
    /// The version.
    Read,
}

impl SequentialSpec for Map {
    type Op = Kind;
    /// The version that a write makes, or a read finds.
    type Ret = u64;

    fn invoke(&mut self, op: &Kind) -> u64 {
        if *op == Kind::Write {
            self.version += 1;
        }
        self.version
    }
}

/// A write or a read, and what was answered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Operation {
    /// In seconds, by one clock for all operations.
    pub began: f64,
    /// In seconds. The operation took effect between the two.
    pub ended: f64,
    /// The version that a write made, or a read found.
    pub version: u64,
    /// Write or read.
    pub kind: Kind,
}

/// Operations on one map, before the first and after the last of which none was under way.
#[derive(Clone, Debug, PartialEq)]
pub struct Window {
    /// The map's name, to be printed.
    pub map: String,
    /// The map's version before the first operation.
    pub before: u64,
    /// The operations, in any order.
    pub operations: Vec<Operation>,
}

impl Window {
    /// Whether some order of the operations, in which none comes before one that had ended when it began, is one that a single map could
    /// have had (Herlihy and Wing, 1990). Takes time that grows exponentially with the operations under way at once.
    pub fn is_linearizable(&self) -> bool {
        // At equal times an end comes after the beginnings: operations that touch are under way at once.
        let mut moments: Vec<(f64, bool, usize)> = Vec::new();
        for (number, operation) in self.operations.iter().enumerate() {
            moments.push((operation.began, false, number));
            moments.push((operation.ended, true, number));
        }
        moments.sort_by(|one, other| one.0.total_cmp(&other.0).then(one.1.cmp(&other.1)));
        let mut tester = LinearizabilityTester::new(Map { version: self.before });
        for (_, is_end, number) in moments {
            let operation = &self.operations[number];
            // Each operation is a client of its own: only time orders them.
            let taken = if is_end {
                tester.on_return(number, operation.version)
            } else {
                tester.on_invoke(number, operation.kind)
            };
            taken.map(drop).expect("each operation begins once and ends once after that");
        }
        tester.is_consistent()
    }
}

/// Reads windows from lines: `window MAP VERSION`, then one line `w|r BEGAN ENDED VERSION` for each of its operations.
///
/// # Errors
///
/// The number of a line that is neither, or of an operation that ends before it begins or stands before the first window.
pub fn read(lines: &str) -> Result<Vec<Window>, String> {
    let mut windows: Vec<Window> = Vec::new();
    for (number, line) in lines.lines().enumerate() {
        let words: Vec<&str> = line.split_whitespace().collect();
        let bad = |why: &dyn fmt::Display| format!("line {}: {why}: {line}", number + 1);
        match words[..] {
            ["window", map, before] => {
                let before = parsed(before).map_err(|error| bad(&error))?;
                windows.push(Window { map: map.to_owned(), before, operations: Vec::new() });
            }
            [kind @ ("w" | "r"), began, ended, version] => {
                let operation = Operation {
                    began: parsed(began).map_err(|error| bad(&error))?,
                    ended: parsed(ended).map_err(|error| bad(&error))?,
                    version: parsed(version).map_err(|error| bad(&error))?,
                    kind: if kind == "w" { Kind::Write } else { Kind::Read },
                };
                if operation.began.is_nan() || operation.ended.is_nan() || operation.ended < operation.began {
                    return Err(bad(&"an operation ends before it begins"));
                }
                let window = windows.last_mut().ok_or_else(|| bad(&"no window comes before it"))?;
                window.operations.push(operation);
            }
            _ => return Err(bad(&"neither a window nor an operation")),
        }
    }
    Ok(windows)
}

fn parsed<T: FromStr<Err: fmt::Display>>(word: &str) -> Result<T, String> {
    word.parse().map_err(|error| format!("{word:?}: {error}"))
}
