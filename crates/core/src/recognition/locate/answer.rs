//! The answer: places with their confidence, and what would tell ambiguous ones apart.

use super::look_for::telling_signs;
use super::map_search::MapSearch;
use super::places::{PlaceEvidence, join, log_odds_alone, sum};
use super::views::View;
use crate::domain::counted::counted;
use crate::domain::ids::KeyframeId;
use crate::domain::location::{Location, LocationVerdict, Place, PlanPose};
use crate::domain::look_for::NearbySign;
use crate::domain::verdict::{Candidate, Reason, ReasonCode};
use crate::recognition::loops::evidence::geometry_skipped;
use crate::recognition::odds::log_odds::LogOdds;
use crate::recognition::odds::sum::Sum;
use crate::recognition::odds::why::why_there;

/// The least confidence with which a place is located.
pub(in crate::recognition) const LOCATED_MIN_CONFIDENCE: f64 = 0.99;
/// A place fits if, were there no other, the camera would rather be there than not.
pub(in crate::recognition) const FITS_FROM: LogOdds = LogOdds::EVEN;

/// Decides where the camera is, from the searches of all maps and the views that geometry looked at; at most `max` places are
/// listed. `alike_cells` is how many cells of a view a place elsewhere was found to explain ([`super::likeness`]): an unmapped
/// one may explain as many of this view. Pure: the same arguments give the same answer, to the bit.
pub fn locate(searches: &[MapSearch], views: &[View], alike_cells: usize, max: usize) -> Location {
    let mut joined = join(searches, views);
    for place in &mut joined {
        place.set_unmapped_rival(alike_cells);
    }
    let sums: Vec<Sum> = (0..joined.len()).map(|at| sum(&joined, at)).collect();
    let confidence = sums.first().map_or(0.0, |first| first.total().probability());
    let verdict = verdict(&joined, confidence);
    let fits = |at: usize| log_odds_alone(&joined[at]) >= FITS_FROM;
    let standing = |at: usize| match verdict {
        LocationVerdict::Located if at == 0 => LocationVerdict::Located,
        LocationVerdict::Ambiguous if fits(at) => LocationVerdict::Ambiguous,
        _ => LocationVerdict::Unknown,
    };
    let places: Vec<Place> = (joined.iter().zip(&sums).enumerate())
        .take(max)
        .map(|(at, (found, sum))| place(searches, views, found, sum, standing(at)))
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
    let reason = reason(searches, verdict, &joined, confidence);
    let why = why_there(verdict, places.first(), reason.as_ref());
    Location { verdict, why, confidence, places, look_for, reason }
}

fn verdict(joined: &[PlaceEvidence], confidence: f64) -> LocationVerdict {
    let fits = |place: &PlaceEvidence| log_odds_alone(place) >= FITS_FROM;
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
    sum: &Sum,
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
        odds: sum.odds(),
        pose: found.pose.as_ref().map(|(_, pose)| pose.clone()),
        in_plan,
        signs: found.signs.clone(),
        verified_views: found.verified_views,
        candidate,
    }
}

/// Returns why there is no place, or why the first one is not certain.
fn reason(
    searches: &[MapSearch],
    verdict: LocationVerdict,
    joined: &[PlaceEvidence],
    confidence: f64,
) -> Option<Reason> {
    let Some(first) = joined.first() else {
        let (code, detail) = if !searches.is_empty() && searches.iter().all(|search| search.is_without_words)
        {
            let detail = "no word of the query could be compared, for it has none or they are of another vocabulary than the maps', \
                and no anchor it sees was seen before";
            (ReasonCode::EmptyBow, detail)
        } else {
            (
                ReasonCode::NoCandidates,
                "no keyframe that may answer shares a word or an anchor with the query",
            )
        };
        return Some(Reason { code, measured: None, limit: None, detail: detail.to_owned() });
    };
    let (code, detail) = match verdict {
        LocationVerdict::Located => return None,
        LocationVerdict::Ambiguous => (
            ReasonCode::PlacesAlike,
            String::from("several places fit, and what tells them apart is too little"),
        ),
        LocationVerdict::Unknown => {
            let cells = counted(first.common_cells, "cell");
            let signs = counted(first.signs.agreeing.len(), "distinctive sign");
            (
                ReasonCode::TooLittleEvidence,
                format!("{cells} of the view and {signs} agree with the first place"),
            )
        }
    };
    Some(Reason { code, measured: Some(confidence), limit: Some(LOCATED_MIN_CONFIDENCE), detail })
}
