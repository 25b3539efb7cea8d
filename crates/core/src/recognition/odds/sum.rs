//! The sum of the evidence for one candidate, under what geometry found.

use std::collections::BTreeSet;

use super::bet::{Bet, Metres, TextPair};
use super::log_odds::LogOdds;
use super::names::{NamePair, Spots};
use super::weights;
use crate::domain::counted::counted;
use crate::domain::settings::Settings;
use crate::domain::verdict::{AnchorName, EvidenceKind, EvidenceTerm, GeometryStatus, Odds};
use crate::geometry::Sim3;
use crate::recognition::extensions::returning::Returning;
use crate::recognition::extensions::tracked_path::{Discrepancy, drift_m};
use crate::recognition::loops::anchor_map::{LocalAnchor, LocalName};
use crate::recognition::loops::geometry_check::GeometryOutcome;
use crate::recognition::map::index::Certainty;
use crate::recognition::verification::Failure;

/// A camera that moves by this many times the distance by which anchors may differ (§V-B) sees most of them elsewhere.
pub(in crate::recognition) const PLACE_WIDTHS: f64 = 1.5;

/// The outcome of geometry, as evidence.
#[derive(Clone, Copy, Debug)]
pub struct ViewFound<'a> {
    /// The outcome.
    pub outcome: &'a GeometryOutcome,
    /// The cells that both views have in common.
    pub cells: usize,
}

/// The terms of a sum.
#[derive(Clone, Debug, Default)]
pub struct Sum {
    /// Them.
    pub terms: Vec<(EvidenceTerm, LogOdds)>,
    /// The names that agree and hang in one place, each in its one spelling.
    pub agreeing: Vec<String>,
}

impl Sum {
    /// Returns the log-odds that the query was taken there.
    pub fn total(&self) -> LogOdds {
        self.terms.iter().map(|(_, log_odds)| *log_odds).sum()
    }

    /// Returns it as it is told.
    pub fn odds(&self) -> Odds {
        Odds {
            terms: self.terms.iter().map(|(term, _)| term.clone()).collect(),
            confidence: self.total().probability(),
        }
    }

    /// Sets the place next to this one against it. The names of a drive are around both; what tells the two apart is where the
    /// cameras stand, by a view or by a sign around both (`is_placed`).
    fn set_neighbour(&mut self, is_placed: bool) {
        let of_spot =
            |kind| matches!(kind, EvidenceKind::NoView | EvidenceKind::Apart | EvidenceKind::Odometry);
        let spot = self.terms.iter().filter(|(term, _)| of_spot(term.kind)).map(|(_, log_odds)| *log_odds);
        let here = if is_placed { weights::HERE } else { weights::NEAR };
        self.limit_to(here + spot.sum());
    }

    /// Sets as much against it for the place next to it as it exceeds this by.
    pub(super) fn limit_to(&mut self, most: LogOdds) {
        let beyond = self.total() - most;
        if beyond > LogOdds::EVEN {
            let about = String::from("the place next to it has these names around it as well");
            self.add(EvidenceKind::Neighbour, Vec::new(), about, -beyond);
        }
    }

    /// Returns the log-odds of the terms of one kind.
    pub fn of(&self, kind: EvidenceKind) -> LogOdds {
        self.terms.iter().filter(|(term, _)| term.kind == kind).map(|(_, log_odds)| *log_odds).sum()
    }

    /// Whether anything speaks for the place.
    pub fn speaks_for(&self) -> bool {
        self.terms.iter().any(|(_, log_odds)| *log_odds > LogOdds::EVEN)
    }

    /// Adds a term; none of no weight but for what is told besides.
    pub fn add(
        &mut self,
        kind: EvidenceKind,
        pairs: Vec<(AnchorName, AnchorName)>,
        about: String,
        log_odds: LogOdds,
    ) {
        self.terms.push((EvidenceTerm { kind, pairs, about, log_odds: log_odds.natural() }, log_odds));
    }

    fn add_names(&mut self, kind: EvidenceKind, pairs: &[&NamePair], weight: impl Fn(&NamePair) -> LogOdds) {
        for pair in pairs {
            let named = |anchor: &LocalAnchor| anchor.description.as_deref().unwrap_or_default().to_owned();
            let about = match kind {
                EvidenceKind::OtherName => format!("{} / {}", named(&pair.query), named(&pair.candidate)),
                _ => named(&pair.query),
            };
            self.add(
                kind,
                vec![(pair.query.name.public(), pair.candidate.name.public())],
                about,
                weight(pair),
            );
        }
    }
}

impl Bet {
    /// Returns the sum of evidence under what geometry found.
    pub fn sum(&self, view: Option<ViewFound<'_>>, settings: &Settings) -> Sum {
        let mut sum = Sum::default();
        let verified = view.filter(|view| view.outcome.verification.status == GeometryStatus::Verified);
        let transform = verified.and_then(|view| {
            let verification = &view.outcome.verification;
            verification.candidate_from_query.filter(|_| verification.model.is_metric())
        });
        let between_poses =
            transform.as_ref().zip(verified).map(|(found, view)| view.outcome.between_poses(found));
        let spots = self.names.by_spot(between_poses.as_ref(), settings);
        self.add_names(&mut sum, &spots, between_poses.is_some());
        let shared = self.add_texts(&mut sum) + self.add_view(&mut sum, verified, settings);
        if settings.building_repeats && shared > weights::NO_COPY {
            let about = String::from("a copy of the place would show the same");
            sum.add(EvidenceKind::Copy, Vec::new(), about, weights::NO_COPY - shared);
        }
        if view.is_none() {
            self.add_absent(&mut sum, &spots);
        }
        add_no_view(&mut sum, view, self.names.alike.iter().any(|pair| pair.known == Returning::InView));
        if self.metres > Metres::None && settings.building_repeats {
            let width_m = PLACE_WIDTHS * settings.anchor_map_max_distance_difference_m;
            let by_view = transform.map(|found| (length_m(&found), width_m));
            let by_signs = || {
                let (apart_m, open_m) = spots.cameras_apart_m().filter(|_| self.metres == Metres::OfSigns)?;
                Some((apart_m, settings.distinctive_place_radius_m + open_m))
            };
            add_apart(&mut sum, by_view.or_else(by_signs));
        }
        self.add_odometry(&mut sum, transform.as_ref(), settings);
        let is_around = spots.agreeing.iter().any(|pair| pair.known != Returning::No);
        // Who only turns is where his drive is.
        let is_placed = verified.is_some() || is_around || self.metres != Metres::OfSigns;
        sum.set_neighbour(is_placed);
        if self.unread > 0 {
            sum.add(EvidenceKind::Unread, Vec::new(), counted(self.unread, "crop"), weights::UNREAD);
        }
        sum
    }

    fn add_names(&self, sum: &mut Sum, spots: &Spots<'_>, has_transform: bool) {
        // One name counts once, however many anchors bear it: as the surest of them has it.
        let mut distinct: Vec<&NamePair> = Vec::new();
        for pair in &spots.agreeing {
            match distinct.iter_mut().find(|known| gist(known) == gist(pair)) {
                Some(known) if known.places == pair.places && known.certainty() < pair.certainty() => {
                    *known = pair;
                }
                Some(_) => {}
                None => distinct.push(pair),
            }
        }
        let (unique, shared): (Vec<&NamePair>, Vec<&NamePair>) =
            distinct.into_iter().partition(|pair| pair.places == 1);
        sum.agreeing = unique.iter().map(|pair| gist(pair).to_owned()).collect();
        sum.add_names(EvidenceKind::Name, &unique, |pair| match pair.certainty() {
            Certainty::Doubtful => weights::NAME_DOUBTFUL,
            Certainty::ReadOnce | Certainty::ReadAlike | Certainty::Sure => weights::NAME,
        });
        sum.add_names(EvidenceKind::SharedName, &shared, |_| LogOdds::EVEN);
        sum.add_names(EvidenceKind::OtherName, &spots.differing, |pair| match pair.certainty() {
            Certainty::Doubtful => weights::OTHER_NAME_DOUBTFUL,
            Certainty::ReadOnce | Certainty::ReadAlike | Certainty::Sure => weights::OTHER_NAME,
        });
        let at_one_spot: BTreeSet<LocalName> =
            spots.differing.iter().flat_map(|pair| [pair.query.name, pair.candidate.name]).collect();
        let is_elsewhere =
            |(a, b): &&(LocalName, LocalName)| !at_one_spot.contains(a) && !at_one_spot.contains(b);
        let strange: Vec<_> = self.names.strange.iter().filter(is_elsewhere).collect();
        if !strange.is_empty() {
            let weight = weights::STRANGE_NAMES * strange.len();
            let pairs = strange.iter().map(|(a, b)| (a.public(), b.public())).collect();
            sum.add(EvidenceKind::StrangeNames, pairs, counted(strange.len(), "name"), weight);
        }
        match (has_transform, spots.displaced.as_slice()) {
            (true, displaced) => {
                sum.add_names(EvidenceKind::DisplacedName, displaced, |_| weights::DISPLACED);
            }
            (false, [first, ..]) => {
                sum.add_names(EvidenceKind::DisplacedName, &[*first], |_| weights::DISPLACED_BY_BEARING);
            }
            (false, []) => {}
        }
    }

    /// Adds the signs of the query that the candidate lacks, where geometry could not compare the views themselves.
    fn add_absent(&self, sum: &mut Sum, spots: &Spots<'_>) {
        if sum.agreeing.is_empty() {
            return;
        }
        let differing: Vec<AnchorName> =
            spots.differing.iter().map(|pair| pair.query.name.public()).collect();
        let absent: Vec<&AnchorName> = self.absent.iter().filter(|sign| !differing.contains(sign)).collect();
        if !absent.is_empty() {
            let weight = (weights::ABSENT * absent.len()).max(weights::ABSENT_MAX);
            sum.add(EvidenceKind::Absent, Vec::new(), counted(absent.len(), "sign"), weight);
        }
    }

    fn add_texts(&self, sum: &mut Sum) -> LogOdds {
        if self.texts.is_empty() {
            return LogOdds::EVEN;
        }
        let weight = |pair: &TextPair| if pair.is_description { weights::DESCRIPTION } else { weights::TEXT };
        let total = self.texts.iter().map(weight).sum::<LogOdds>().min(weights::TEXTS_MAX);
        let pairs = self.texts.iter().map(|pair| (pair.query.clone(), pair.candidate.clone())).collect();
        let texts: Vec<&str> = self.texts.iter().map(|pair| pair.text.as_str()).collect();
        sum.add(EvidenceKind::Texts, pairs, texts.join(", "), total);
        total
    }

    /// Adds the part of the view that geometry explains.
    fn add_view(&self, sum: &mut Sum, verified: Option<ViewFound<'_>>, settings: &Settings) -> LogOdds {
        let Some(view) = verified else { return LogOdds::EVEN };
        if self.is_here && !view.outcome.verification.model.is_metric() {
            // The next frame of one drive shows the same view.
            return LogOdds::EVEN;
        }
        let is_metric = view.outcome.verification.model.is_metric();
        let of_cells = if is_metric { explained(view.cells) } else { without_length(view.cells) };
        let may_repeat = settings.building_repeats || !is_metric;
        let least = if may_repeat { LogOdds::EVEN } else { weights::VIEW_THAT_DOES_NOT_REPEAT };
        let explained = of_cells.max(least);
        sum.add(EvidenceKind::View, Vec::new(), counted(view.cells, "cell"), explained);
        explained
    }

    fn add_odometry(&self, sum: &mut Sum, transform: Option<&Sim3>, settings: &Settings) {
        let Some((path, apart_m)) = &self.path else { return };
        let off = if let Some(transform) = transform {
            path.discrepancy(transform, settings).map(|found| match found {
                Discrepancy::Metres { off, .. } => format!("{off:.2} m off"),
                Discrepancy::Radians { off, .. } => format!("turned by {off:.2} rad"),
            })
        } else {
            let limit_m = drift_m(path.length_m, settings.distinctive_place_radius_m, settings);
            (*apart_m > limit_m).then(|| format!("{apart_m:.1} m apart"))
        };
        if let Some(off) = off {
            sum.add(EvidenceKind::Odometry, Vec::new(), off, weights::ELSEWHERE);
        }
    }
}

fn gist(pair: &NamePair) -> &str {
    pair.query.text.as_ref().map_or("", |text| text.gist())
}

/// Adds that geometry finds no common view, where both keyframes would allow it. Without map points on both sides, two images
/// of one sign often have little else in common.
fn add_no_view(sum: &mut Sum, view: Option<ViewFound<'_>>, is_sign_in_view: bool) {
    let Some(ViewFound { outcome, cells }) = &view else { return };
    let verification = &outcome.verification;
    let has_common_view = match verification.status {
        // Two keyframes with map points at one place see enough of these both, or most of one view.
        GeometryStatus::Verified => {
            verification.model.is_metric() || !outcome.are_triangulated || is_most_of_view(*cells)
        }
        GeometryStatus::Failed => false,
        GeometryStatus::Skipped => !matches!(verification.failure, Some(Failure::TooFewMatches { .. })),
    };
    if has_common_view {
        return;
    }
    let is_by_points = outcome.are_triangulated || verification.model.is_metric();
    let weight = match () {
        () if verification.status == GeometryStatus::Verified => weights::NO_COMMON_POINTS,
        () if is_by_points => weights::NO_VIEW,
        () if is_sign_in_view => weights::NO_VIEW_IN_IMAGES,
        () => weights::NO_VIEW_OF_A_SIGN,
    };
    let why = verification
        .failure
        .map_or_else(|| String::from("too few common map points"), |failure| failure.to_string());
    sum.add(EvidenceKind::NoView, Vec::new(), why, weight);
}

/// Returns the worth of the cells of a view.
pub fn explained(cells: usize) -> LogOdds {
    LogOdds::of((cells as f64 - weights::EVEN_CELLS) / weights::CELLS_PER_LOG_ODDS)
}

/// Returns the worth of the cells of a view without a length. It is a view, and not a place: what is seen in both may be far from
/// either.
fn without_length(cells: usize) -> LogOdds {
    explained(cells / 2)
}

/// Whether a view without a length shows so much that the cameras stand at one place.
fn is_most_of_view(cells: usize) -> bool {
    without_length(cells) >= weights::NAME - weights::NO_COPY
}

fn length_m(transform: &Sim3) -> f64 {
    transform.translation_m().iter().fold(0.0_f64, |length, axis| libm::hypot(length, *axis))
}

/// Adds that the cameras are farther apart than a place is wide: each shows part of what the other does, from the place next to
/// it.
fn add_apart(sum: &mut Sum, apart: Option<(f64, f64)>) {
    if let Some((apart_m, _)) = apart.filter(|(apart_m, limit_m)| apart_m > limit_m) {
        sum.add(EvidenceKind::Apart, Vec::new(), format!("{apart_m:.1} m"), weights::ELSEWHERE);
    }
}
