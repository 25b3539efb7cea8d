//! Rivals: other places of the map for which as much speaks.

use super::log_odds::LogOdds;
use super::sum::Sum;
use crate::domain::verdict::EvidenceKind;

/// Returns what the strongest other place takes from a candidate, and its number; none if none is likelier than not.
pub fn strongest_rival(
    sums: &[Option<Sum>],
    at: usize,
    is_joined: impl Fn(usize, usize) -> bool,
) -> Option<(usize, LogOdds)> {
    let own = sums[at].as_ref()?;
    // One name hangs in one place, whichever of the query's signs bears it.
    let shares_name = |other: &Sum| other.agreeing.iter().any(|name| own.agreeing.contains(name));
    let rivals = sums.iter().enumerate().filter_map(|(number, sum)| Some((number, sum.as_ref()?)));
    let elsewhere = rivals.filter(|(number, sum)| {
        *number != at
            && !is_joined(at, *number)
            && !shares_name(sum)
            && sum.of(EvidenceKind::Name) > LogOdds::EVEN
    });
    let likely = elsewhere.map(|(number, sum)| (number, sum.total()));
    likely
        .filter(|(_, total)| *total > LogOdds::EVEN)
        .max_by_key(|(number, total)| (*total, std::cmp::Reverse(*number)))
}
