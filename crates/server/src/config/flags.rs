//! Flags: what the groups of settings parse theirs with.

use std::ops::RangeInclusive;
use std::str::FromStr;

use clap::{Args, Command, Error};

/// Parses a number within a range.
pub(super) fn number<T: FromStr + PartialOrd>(
    text: &str,
    range: RangeInclusive<T>,
    expected: &str,
) -> Result<T, String> {
    let number = text.parse().ok().filter(|number| range.contains(number));
    number.ok_or_else(|| format!("expected {expected}"))
}

/// Parses the flags of one group, as a command line would give them.
pub(super) fn parsed<A: Args>(flags: &[impl AsRef<str>]) -> Result<A, Error> {
    let line = std::iter::once("revisit").chain(flags.iter().map(AsRef::as_ref));
    A::from_arg_matches(&A::augment_args(Command::new("revisit")).try_get_matches_from(line)?)
}
