//! Why: the answer in one sentence, in plain words.

use crate::domain::verdict::{Candidate, Decision, EvidenceKind, EvidenceTerm, GeometryStatus, Reason};

/// Names that a sentence lists.
const NAMED_MAX: usize = 4;

/// Returns why the answer is what it is: by its best candidate, or the reason where no candidate says it.
pub fn why(decision: Decision, best: Option<&Candidate>, reason: Option<&Reason>) -> String {
    if let Some(reason) = reason {
        return sentence(&reason.detail);
    }
    let Some(best) = best else { return String::from("Nothing like it is in the map.") };
    match decision {
        Decision::Loop => for_loop(best),
        Decision::NoLoop => against(best),
        Decision::Undecided => undecided(best),
    }
}

fn for_loop(best: &Candidate) -> String {
    let names = about(best, EvidenceKind::Name);
    if !names.is_empty() {
        return format!("Both read {}; no other place in this map does.", listed(&names));
    }
    if best.geometry.status == GeometryStatus::Verified {
        return String::from("The two images show the same things at the same places.");
    }
    String::from("The signs around the two agree.")
}

fn against(best: &Candidate) -> String {
    if let Some(other) = about(best, EvidenceKind::OtherName).first()
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

fn about(candidate: &Candidate, kind: EvidenceKind) -> Vec<&str> {
    let terms = candidate.odds.iter().flat_map(|odds| &odds.terms);
    let of_kind = |term: &&EvidenceTerm| term.kind == kind;
    terms.filter(of_kind).map(|term| term.about.as_str()).collect()
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
