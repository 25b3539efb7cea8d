//! M7, "why not?": each identifier that differs without stopping a candidate says why.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_3};

use revisit_core::domain::difference::{DifferenceEvidence, DifferenceReason};
use revisit_core::{Candidate, CandidateDecision, ReasonCode, Settings};

use super::scene::{Scene, Thing, anchors, code, door, keyframe, reason, to_the_letter, told};

const AHEAD: [f64; 3] = [0.0, 0.0, 1.0];

/// The differences between two passages of one keyframe each.
fn between(
    settings: &Settings,
    query: &[Thing],
    candidate: &[Thing],
) -> (Candidate, Vec<DifferenceEvidence>) {
    let mut scene = Scene::with(settings.clone());
    scene.put("candidate", keyframe().sees(candidate.iter().cloned()));
    scene.put("query", keyframe().sees(query.iter().cloned()));
    let found = scene.compare("query", "candidate");
    let differences = anchors(&found).differences.clone();
    (found, differences)
}

#[test]
fn a_differing_identifier_says_why_it_is_no_contradiction() {
    use DifferenceReason::{AnotherPlace, KnownElsewhere, NoConflict, Outweighed, PairedOtherwise, VetoOff};
    let plate = |text: &str| door(text, AHEAD);
    let check_with =
        |settings: &Settings, query: &[Thing], candidate: &[Thing], reason, figures: Option<(f64, f64)>| {
            let (found, differences) = between(settings, query, candidate);
            let told_so = differences.iter().find(|pair| pair.reason == reason);
            let pair = told_so.unwrap_or_else(|| panic!("{reason:?}: {found:#?}"));
            assert!(!pair.query_identifier.is_empty() && !pair.candidate_identifier.is_empty(), "{pair:?}");
            assert!(!pair.detail.is_empty(), "{pair:?}");
            match figures {
                Some((measured, limit)) => {
                    told(reason.as_str(), pair.measured, measured);
                    told(reason.as_str(), pair.limit, limit);
                }
                None => assert_eq!((pair.measured, pair.limit), (None, None), "{pair:?}"),
            }
        };
    let check = |query: &[Thing], candidate: &[Thing], reason, figures| {
        check_with(&Settings::default(), query, candidate, reason, figures);
    };
    let one = [plate("104")];
    check(&one, &[door("110", [0.0, 0.0, 2.5])], AnotherPlace, Some((1.5, 1.0)));
    check(&one, &[door("110", [1.0, 0.0, 0.0])], AnotherPlace, Some((FRAC_PI_2, FRAC_PI_3)));
    check(&one, &[plate("110"), door("104", [0.0, 0.0, -5.0])], KnownElsewhere, None);
    check(&one, &[plate("1O4")], NoConflict, None);
    check(&[plate("104"), door("107", [0.3, 0.0, 1.2])], &[plate("220")], PairedOtherwise, None);
    let agrees = || door("215", [0.5, 0.0, 0.0]);
    check(&[plate("104"), agrees()], &[plate("110"), agrees()], Outweighed, Some((2.0, 4.0)));
    check_with(&to_the_letter(), &one, &[plate("110")], VetoOff, None);
}

#[test]
fn contradictions_and_agreements_are_not_differences() {
    let plate = |text: &str| [door(text, AHEAD)];
    let settings = &Settings::default();
    let (found, differences) = between(settings, &plate("104"), &plate("110"));
    assert_eq!((code(&found), differences.len()), (Some(ReasonCode::Contradiction), 0));
    let (found, differences) = between(settings, &plate("104"), &plate("104"));
    assert_eq!((found.decision, differences.len()), (CandidateDecision::Loop, 0));
    let (_, differences) = between(settings, &plate("Turing"), &plate("Curie"));
    assert_eq!(differences.len(), 0, "names are no identifiers");
}

#[test]
fn differences_are_few_and_the_nearest_signs_come_first() {
    let hall = |first: u32| -> Vec<Thing> {
        (0..30).map(|n| door(&format!("{}", first + n * 7), [f64::from(n) * 2.0, 0.0, 1.5])).collect()
    };
    let (found, differences) = between(&Settings::default(), &hall(1000), &hall(5001));
    assert_eq!(code(&found), Some(ReasonCode::Contradiction), "{found:#?}");
    assert!(differences.len() <= 8, "{}", differences.len());
    let (_, differences) = between(&to_the_letter(), &hall(1000), &hall(5001));
    assert_eq!(differences.len(), 8);
    assert_eq!(differences[0].query_identifier, "1000");
    assert_eq!(differences[0].candidate_identifier, "5001");
}

#[test]
fn a_low_score_names_the_anchor_and_what_failed() {
    for (query, candidate, said) in [
        (door("901", AHEAD), door("901", [0.0, 0.0, 2.5]), "“901” is in both, but 1.50 m nearer or farther"),
        (door("901", AHEAD), door("901", [1.0, 0.0, 0.0]), "“901” is in both, but 1.57 rad aside"),
        (door("901", AHEAD), door("910", AHEAD), "nothing that is read in one is read in the other"),
    ] {
        let (found, _) = between(&to_the_letter(), &[query], &[candidate]);
        assert_eq!(code(&found), Some(ReasonCode::ScoreBelowThreshold), "{found:#?}");
        let detail = &reason(&found).detail;
        assert!(detail.contains(said), "{detail:?} does not say {said}");
    }
}
