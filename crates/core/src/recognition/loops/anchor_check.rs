//! Check 3 of §V: the local anchor map around the query against that around each candidate.

use std::cell::OnceCell;
use std::sync::Arc;

use super::anchor_map::{LocalAnchor, LocalAnchorMap, LocalName, local_anchor_map};
use super::centre::Centre;
use super::comparison::{Comparison, Matched, compare, matched};
use super::evidence;
use super::geometry_snapshot::GeometrySnapshot;
use super::letter::judge_anchors;
use super::low_score::explain_low_score;
use super::query::Query;
use super::screening::{PreVerified, Stage};
use crate::domain::ids::KeyframeSeq;
use crate::domain::look_for::NearbySign;
use crate::domain::method::Method;
use crate::domain::verdict::{Candidate, ReasonCode, Verify};
use crate::recognition::extensions::closed_return::repeated_loop;
use crate::recognition::extensions::company::Companies;
use crate::recognition::extensions::distinctiveness::PlaceCounts;
use crate::recognition::extensions::returning::{Returning, is_in_view, is_tracked, returning_identifier};
use crate::recognition::extensions::tracked_path::TrackedPath;
use crate::recognition::extensions::worst_case::{awaited, model_is_missed, worst_case};
use crate::recognition::locate::look_for::NEARBY_MAX;
use crate::recognition::map::index::MapIndex;
use crate::recognition::odds::bet::{Bet, Metres, TextPair};
use crate::recognition::odds::drive::{chain_around, chain_back, moves, named_signs};
use crate::recognition::odds::names::Names;

/// A query's surroundings, to be held against those of its candidates.
#[derive(Debug)]
pub struct AnchorCheck<'a> {
    index: &'a MapIndex,
    query: &'a Query<'a>,
    verify: Verify,
    around: LocalAnchorMap,
    /// The signs with names that the query's drive has read.
    own_signs: OnceCell<Vec<Arc<LocalAnchor>>>,
    /// The keyframes of that drive.
    own_chain: OnceCell<Vec<KeyframeSeq>>,
}

/// Counts that all candidates of a query share.
#[derive(Debug)]
pub struct Counts {
    /// The places at which texts hang.
    pub places: PlaceCounts,
    companies: Companies,
}

impl Counts {
    /// Returns the counts for a query around this centre.
    pub fn around(index: &MapIndex, centre: &Centre) -> Self {
        Self { places: PlaceCounts::around(index, centre), companies: Companies::default() }
    }
}

impl<'a> AnchorCheck<'a> {
    /// Takes the local anchor map around the query.
    pub fn new(index: &'a MapIndex, query: &'a Query<'a>, verify: Verify, counts: &mut Counts) -> Self {
        let around = local_anchor_map(index, &query.centre, &mut counts.places);
        Self { index, query, verify, around, own_signs: OnceCell::new(), own_chain: OnceCell::new() }
    }

    /// Checks one candidate; returns none if its keyframe was culled.
    pub fn check(
        &self,
        keyframe: KeyframeSeq,
        mut candidate: Candidate,
        counts: &mut Counts,
    ) -> Option<PreVerified> {
        let (index, settings) = (self.index, &self.index.properties().settings);
        let centre = Centre::stored(index, keyframe)?;
        let around = local_anchor_map(index, &centre, &mut counts.places);
        let comparison = compare(&self.around, &around, index, settings);
        candidate.anchors = Some(evidence::anchors(&comparison, settings));
        let mut pre_verified = match settings.method {
            Method::Paper => self.by_letter(keyframe, candidate, &around, &comparison),
            Method::Revisit => {
                let bet = self.bet(keyframe, &centre, &around, &comparison, counts);
                let stage = match () {
                    () if !bet.may_win(settings) => Stage::Stopped,
                    () if bet.names.alike.is_empty() => Stage::AskGeometry,
                    () => Stage::AnchorsAgree,
                };
                PreVerified { bet: Some(bet), ..PreVerified::at(stage, keyframe, candidate) }
            }
        };
        pre_verified.is_degraded = model_is_missed(index, &self.around, &around);
        if pre_verified.stage != Stage::Stopped && self.verify != Verify::Anchors {
            pre_verified.snapshot = GeometrySnapshot::stored(index, keyframe);
        }
        if pre_verified.stage != Stage::Stopped && settings.is_ours() && !self.query.again {
            pre_verified.repeats = repeated_loop(index, &comparison, self.query, keyframe);
        }
        Some(pre_verified)
    }

    /// Returns a candidate as the paper's letter has it.
    fn by_letter(
        &self,
        keyframe: KeyframeSeq,
        candidate: Candidate,
        around: &LocalAnchorMap,
        comparison: &Comparison<'_>,
    ) -> PreVerified {
        let (index, query) = (self.index, self.query);
        let settings = &index.properties().settings;
        let worst = self.reads().then(|| worst_case(index, &self.around, around, comparison)).flatten();
        match judge_anchors(settings, comparison, worst, self.missing(around)) {
            Err((decision, mut reason)) => {
                if reason.code == ReasonCode::ScoreBelowThreshold {
                    let why = explain_low_score([&self.around, around], comparison, index.texts(), settings);
                    reason.detail = format!("{}: {why}", reason.detail);
                }
                PreVerified::stopped(keyframe, candidate, decision, reason)
            }
            Ok(stage) => PreVerified {
                identifier: returning_identifier(index, comparison, query, query.nearest(), keyframe),
                ..PreVerified::at(stage, keyframe, candidate)
            },
        }
    }

    /// Whether a model reads crops, so that descriptions come by themselves.
    fn reads(&self) -> bool {
        self.query.roles.vision || self.index.model_away()
    }

    /// Returns what descriptions around the query and a candidate wait for.
    fn missing(&self, around: &LocalAnchorMap) -> ReasonCode {
        match () {
            () if !self.reads() || awaited(self.index, &self.around, around) == 0 => ReasonCode::NotDescribed,
            () if self.index.model_away() => ReasonCode::LlmUnavailable,
            () => ReasonCode::LlmPending,
        }
    }

    /// Returns the bet on a candidate (M64).
    fn bet(
        &self,
        keyframe: KeyframeSeq,
        centre: &Centre,
        around: &LocalAnchorMap,
        comparison: &Comparison<'_>,
        counts: &mut Counts,
    ) -> Bet {
        let (index, query) = (self.index, self.query);
        let settings = &index.properties().settings;
        let nearest = query.nearest();
        let own_chain = self
            .own_chain
            .get_or_init(|| nearest.map(|nearest| chain_back(index, nearest)).unwrap_or_default());
        let own_signs = self
            .own_signs
            .get_or_init(|| named_signs(index, &query.centre, own_chain, &self.around, &mut counts.places));
        // Without a name of the query's, those of the candidate's drive agree with nothing.
        let chain = if own_signs.is_empty() { Vec::new() } else { chain_around(index, keyframe) };
        let signs = named_signs(index, centre, &chain, around, &mut counts.places);
        let is_around = |sign: &LocalAnchor, map: &LocalAnchorMap| {
            map.anchors.iter().any(|anchor| anchor.name == sign.name)
        };
        let tracked =
            |pair: &Matched<'_>| nearest.is_some_and(|query| is_tracked(index, pair, query, keyframe));
        let session = query.centre.session.filter(|session| centre.session == Some(*session));
        let seen = index.objects_seen_by(keyframe);
        let Counts { places, companies } = counts;
        let names = Names::between(
            index,
            own_signs,
            &signs,
            |a, b, judged| {
                let pair = matched(index, session, a, b, judged);
                (!tracked(&pair)).then_some(pair)
            },
            |pair| match () {
                () if is_in_view(pair, &query.seen, &seen) => Returning::InView,
                () if is_around(pair.query, &self.around) && is_around(pair.candidate, around) => {
                    Returning::Around
                }
                () => Returning::No,
            },
            |pair| companies.differs(index, [&pair.query, &pair.candidate], [own_signs, &signs], places),
        );
        let is_named = |pair: &Matched<'_>| {
            [pair.query, pair.candidate]
                .iter()
                .any(|anchor| anchor.text.as_ref().is_some_and(|text| text.has_own_name()))
        };
        let texts = comparison.matches.iter().filter(|pair| !is_named(pair) && !tracked(pair));
        let texts = texts.map(|pair| TextPair {
            query: pair.query.name.public(),
            candidate: pair.candidate.name.public(),
            text: pair.query.description.as_deref().unwrap_or_default().to_owned(),
            is_description: pair.places == 1
                && pair.query.text.as_ref().is_some_and(|text| text.is_described()),
        });
        let path = query.keyframe.filter(|_| settings.odometry_max_drift_share > 0.0);
        let path = path.and_then(|query| TrackedPath::between(index, query, keyframe)).map(|path| {
            (path, (query.centre.map_from_camera.centre() - centre.map_from_camera.centre()).norm())
        });
        let known: Vec<LocalName> = names.alike.iter().map(|pair| pair.query.name).collect();
        let agreeing: Vec<LocalName> = names.alike.iter().map(|pair| pair.candidate.name).collect();
        let nearby = signs.iter().filter(|sign| sign.places == 1 && !agreeing.contains(&sign.name));
        let nearby = nearby.take(NEARBY_MAX).map(|sign| NearbySign {
            class: sign.class.to_string(),
            description: sign.description.as_deref().unwrap_or_default().to_owned(),
            position: sign.centre_in_session,
        });
        let nearby = nearby.collect();
        let strange: Vec<LocalName> = names.strange.iter().map(|(query, _)| *query).collect();
        let absent = comparison.unmatched_of_query.iter().map(|sign| sign.name);
        let absent = absent.filter(|name| !known.contains(name) && !strange.contains(name));
        let absent = absent.map(LocalName::public).collect();
        let unread = if self.reads() { awaited(index, &self.around, around) } else { 0 };
        Bet {
            names,
            texts: texts.collect(),
            absent,
            nearby,
            path,
            is_here: self.is_here(keyframe),
            is_tracked_only: !comparison.matches.is_empty() && comparison.matches.iter().all(tracked),
            metres: match index.properties().metric {
                true if moves(index, own_chain) && moves(index, &chain) => Metres::OfSigns,
                true => Metres::OfViews,
                false => Metres::None,
            },
            unread,
            pending: if comparison.best_case.agreeing_weight > comparison.agreeing_weight() {
                comparison.pending
            } else {
                0
            },
            missing: self.missing(around),
        }
    }

    /// Whether the query's session has the two keyframes at one place.
    fn is_here(&self, candidate: KeyframeSeq) -> bool {
        let (index, query) = (self.index, self.query);
        let radius_m = index.properties().settings.distinctive_place_radius_m;
        index.keyframe(candidate).is_some_and(|candidate| {
            let apart_m = (query.centre.map_from_camera.centre() - candidate.map_from_camera.centre()).norm();
            query.centre.session == Some(candidate.session) && apart_m <= radius_m
        })
    }
}
