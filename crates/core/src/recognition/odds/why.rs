//! Why: the answer in one sentence, in plain words.

use crate::domain::location::{LocationVerdict, Place};
use crate::domain::look_for::LookFor;
use crate::domain::verdict::{Candidate, Decision, EvidenceKind, EvidenceTerm, GeometryStatus, Odds, Reason};

/// Names that a sentence lists.
const NAMED_MAX: usize = 4;

/// Returns why the answer is what it is: by its best candidate, or the reason where no candidate says it.
pub fn why(
    decision: Decision,
    best: Option<&Candidate>,
    reason: Option<&Reason>,
    look_for: &[LookFor],
) -> String {
    if let Some(reason) = reason {
        return sentence(&reason.detail);
    }
    let Some(best) = best else { return String::from("Nothing like it is in the map.") };
    match decision {
        Decision::Loop => for_loop(best),
        Decision::NoLoop => against(best),
        Decision::Undecided => match look_for {
            [] => undecided(best),
            [look_for, ..] => format!("{} Look for {}.", undecided(best), look_for.sign.description),
        },
    }
}

/// Returns why the answer to "where am I?" is what it is.
pub fn why_there(verdict: LocationVerdict, first: Option<&Place>, reason: Option<&Reason>) -> String {
    if let Some(reason) = reason {
        return sentence(&reason.detail);
    }
    let Some(first) = first.filter(|_| verdict == LocationVerdict::Located) else {
        return String::from("Nothing speaks for any place.");
    };
    let names = about(&first.odds, EvidenceKind::Name);
    if names.is_empty() {
        let view = about(&first.odds, EvidenceKind::View);
        return format!("This place alone explains {} of the view.", listed(&view));
    }
    format!("It reads {}; no other place of the maps does.", listed(&names))
}

fn for_loop(best: &Candidate) -> String {
    let names = of_candidate(best, EvidenceKind::Name);
    if !names.is_empty() {
        return format!("Both read {}; no other place in this map does.", listed(&names));
    }
    if best.geometry.status == GeometryStatus::Verified {
        return String::from("The two images show the same things at the same places.");
    }
    String::from("The signs around the two agree.")
}

fn against(best: &Candidate) -> String {
    if let Some(other) = of_candidate(best, EvidenceKind::OtherName).first()
        && let Some((here, there)) = other.split_once(" / ")
    {
        return format!("Here it reads {here}; at the same spot there it reads {there}.");
    }
    best.reason
        .as_ref()
        .map_or_else(|| String::from("Nothing speaks for any place."), |reason| sentence(&reason.detail))
}

fn undecided(best: &Candidate) -> String {
    let likely = format!("It may be {}", best.keyframe);
    match &best.reason {
        Some(reason) => format!("{likely}, but {}.", reason.detail.trim_end_matches('.')),
        None => format!("{likely}."),
    }
}

fn of_candidate(candidate: &Candidate, kind: EvidenceKind) -> Vec<&str> {
    candidate.odds.as_ref().map_or_else(Vec::new, |odds| about(odds, kind))
}

fn about(odds: &Odds, kind: EvidenceKind) -> Vec<&str> {
    let of_kind = |term: &&EvidenceTerm| term.kind == kind;
    odds.terms.iter().filter(of_kind).map(|term| term.about.as_str()).collect()
}

fn listed(names: &[&str]) -> String {
    match names {
        [] => String::new(),
        [one] => (*one).to_owned(),
        [first @ .., last] if names.len() <= NAMED_MAX => format!("{} and {last}", first.join(", ")),
        more => format!("{} and {} others", more[..NAMED_MAX - 1].join(", "), more.len() - NAMED_MAX + 1),
    }
}

/// Returns a reason's words as a sentence.
fn sentence(detail: &str) -> String {
    let mut characters = detail.chars();
    let first = characters.next().map(char::to_uppercase).into_iter().flatten();
    let sentence: String = first.chain(characters).collect();
    if sentence.ends_with('.') { sentence } else { format!("{sentence}.") }
}
