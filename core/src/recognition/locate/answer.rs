//! The answer: places with their confidence, and what would tell ambiguous ones apart.

use super::confidence::LOCATED_MIN_CONFIDENCE;
use super::look_for::{NearbySign, telling_signs};
use super::map_search::MapSearch;
use super::places::{PlaceEvidence, evidence, evidence_alone, join};
use super::views::View;
use crate::domain::counted::counted;
use crate::domain::ids::KeyframeId;
use crate::domain::location::{Location, LocationVerdict, Place, PlanPose};
use crate::domain::verdict::{Candidate, Reason, ReasonCode};
use crate::recognition::loops::evidence::{geometry_skipped, no_candidates};

/// A place fits if, were there no other, the camera would rather be there than not.
pub(in crate::recognition) const FITS_FROM_LOG_ODDS: f64 = 0.0;

/// Decides where the camera is, from the searches of all maps and the views that geometry looked at; at most `max` places are
/// listed. `alike_cells` is how many cells of a view a place elsewhere was found to explain ([`super::likeness`]): an unmapped
/// one may explain as many of this view. Pure: the same arguments give the same answer, to the bit.
pub fn locate(searches: &[MapSearch], views: &[View], alike_cells: usize, max: usize) -> Location {
    let mut joined = join(searches, views);
    for place in &mut joined {
        place.set_unmapped_rival(alike_cells);
    }
    let confidences: Vec<f64> = (0..joined.len()).map(|at| evidence(&joined, at).confidence()).collect();
    let confidence = confidences.first().copied().unwrap_or(0.0);
    let verdict = verdict(&joined, confidence);
    let fits = |at: usize| evidence_alone(&joined[at]).log_odds() >= FITS_FROM_LOG_ODDS;
    let standing = |at: usize| match verdict {
        LocationVerdict::Located if at == 0 => LocationVerdict::Located,
        LocationVerdict::Ambiguous if fits(at) => LocationVerdict::Ambiguous,
        _ => LocationVerdict::Unknown,
    };
    let places: Vec<Place> = (joined.iter().zip(&confidences).enumerate())
        .take(max)
        .map(|(at, (found, confidence))| place(searches, views, found, *confidence, standing(at)))
        .collect();
    let look_for = match verdict {
        LocationVerdict::Ambiguous => {
            let rivals: Vec<(usize, &[NearbySign])> = (0..places.len())
                .filter(|at| fits(*at))
                .map(|at| {
                    (at, joined[at].site.map_or(&[][..], |site| &searches[joined[at].map].sites[site].signs))
                })
                .collect();
            telling_signs(&rivals)
        }
        LocationVerdict::Located | LocationVerdict::Unknown => Vec::new(),
    };
    let reason = reason(searches, verdict, &joined);
    Location { verdict, confidence, places, look_for, reason }
}

fn verdict(joined: &[PlaceEvidence], confidence: f64) -> LocationVerdict {
    let fits = |place: &PlaceEvidence| evidence_alone(place).log_odds() >= FITS_FROM_LOG_ODDS;
    match joined {
        [] => LocationVerdict::Unknown,
        _ if confidence >= LOCATED_MIN_CONFIDENCE => LocationVerdict::Located,
        [first, second, ..] if fits(first) && fits(second) => LocationVerdict::Ambiguous,
        _ => LocationVerdict::Unknown,
    }
}

fn place(
    searches: &[MapSearch],
    views: &[View],
    found: &PlaceEvidence,
    confidence: f64,
    verdict: LocationVerdict,
) -> Place {
    let search = &searches[found.map];
    let site = found.site.map(|site| &search.sites[site]);
    let of_pose = || found.anchor_pose.map(|number| search.pose_sessions[number].clone());
    let session = site.map(|site| site.session_id.clone()).or_else(of_pose).unwrap_or_default();
    let keyframe: Option<KeyframeId> = site.map(|site| site.id.clone());
    let unlooked = || {
        found.best.map(|chosen| {
            let mut candidate: Candidate =
                search.screenings[chosen.asked].candidates[chosen.candidate].candidate.clone();
            candidate.geometry = geometry_skipped("other candidates were more promising");
            candidate
        })
    };
    let in_plan = found.pose.as_ref().and_then(|(session, pose)| {
        let plan = search.plans.get(session)?;
        let plan_from_camera = plan.plan_from_session.after(&pose.map_from_camera);
        Some(PlanPose { frame: plan.frame_id.clone(), plan_from_camera })
    });
    let candidate = found.view.map(|view| views[view].candidate.clone()).or_else(unlooked);
    Place {
        map: found.map,
        keyframe,
        asked: found.asked,
        session,
        verdict,
        confidence,
        pose: found.pose.as_ref().map(|(_, pose)| pose.clone()),
        in_plan,
        signs: found.signs.clone(),
        verified_views: found.verified_views,
        candidate,
    }
}

/// Returns why there is no place, or why the first one is not certain.
fn reason(searches: &[MapSearch], verdict: LocationVerdict, joined: &[PlaceEvidence]) -> Option<Reason> {
    let Some(first) = joined.first() else {
        let empty_bow = searches.iter().all(|search| search.is_without_words);
        return Some(no_candidates(empty_bow));
    };
    let of_first = evidence(joined, 0);
    let (code, detail) = match verdict {
        LocationVerdict::Located => return None,
        LocationVerdict::Ambiguous => {
            let cells = counted(of_first.cells, "cell");
            (ReasonCode::PlacesAlike, format!("the first place alone explains {cells} of the view"))
        }
        LocationVerdict::Unknown => {
            let cells = counted(evidence_alone(first).cells, "cell");
            let signs = counted(first.signs.agreeing.len(), "distinctive sign");
            (
                ReasonCode::TooLittleEvidence,
                format!("{cells} of the view and {signs} agree with the first place"),
            )
        }
    };
    Some(Reason { code, measured: Some(of_first.confidence()), limit: Some(LOCATED_MIN_CONFIDENCE), detail })
}
