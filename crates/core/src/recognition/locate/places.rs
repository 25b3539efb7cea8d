//! Places: the views and anchor poses that speak of one place, together, and what each explains that no other does.

use std::cmp::Ordering;
use std::collections::BTreeSet;

use super::explained_cells::Cells;
use super::likeness::SINGLE_VIEW_FACTOR;
use super::map_search::MapSearch;
use super::selection::{Chosen, ranked};
use super::views::View;
use crate::domain::ids::SessionSeq;
use crate::domain::location::{LocatedPose, SignEvidence};
use crate::geometry::Point3;
use crate::recognition::odds::log_odds::LogOdds;
use crate::recognition::odds::place::PlaceBet;
use crate::recognition::odds::sum::Sum;

/// Places that are told apart; those of which less is known are left out.
const PLACES_MAX: usize = 40;
/// The same for a pose in a plan's frame and one in a session's: an alignment has an error of its own, in metres.
pub(in crate::recognition) const SAME_SPOT_IN_PLAN_M: f64 = 3.0;
/// Poses of one session that are this near to each other are one place, in metres.
pub(in crate::recognition) const SAME_SPOT_M: f64 = 1.0;

/// Evidence for one site or anchor pose, before what lies beside each other is joined.
#[derive(Clone, Debug, Default)]
struct Clue {
    map: usize,
    /// The keyframe; none where only a plan's anchors say it.
    site: Option<usize>,
    /// The candidate, unless it is an anchor pose.
    chosen: Option<Chosen>,
    /// The number of its view, where geometry looked at it.
    view: Option<usize>,
    /// The number of its anchor pose in its map's search.
    anchor_pose: Option<usize>,
    /// The session and the centre of the first keyframe's camera in its frame, where it gives a pose.
    stands_at: Option<(SessionSeq, Point3)>,
    agreeing: BTreeSet<String>,
    contradicting: u32,
    common_cells: usize,
    words: f64,
}

/// All that speaks of one place.
#[derive(Clone, Debug)]
pub struct PlaceEvidence {
    /// The map, by its number.
    pub map: usize,
    /// The site that stands for it; none where only a plan's anchors say it.
    pub site: Option<usize>,
    /// Its best candidate, where it has one.
    pub best: Option<Chosen>,
    /// The number of the view of its best candidate, where geometry looked at it.
    pub view: Option<usize>,
    /// The pose of the first keyframe, by anchors or views, and the session in whose frame it is.
    pub pose: Option<(SessionSeq, LocatedPose)>,
    /// The anchor pose that it rests on, by its number in its map's search.
    pub anchor_pose: Option<usize>,
    /// The signs.
    pub signs: SignEvidence,
    /// The keyframes of the place that geometry verified.
    pub verified_views: u32,
    /// The number of the asked keyframe that the site shows.
    pub asked: usize,
    /// The cells that its best view of each keyframe explains.
    pub cells: Cells,
    /// The most cells that its best view of one keyframe has in common with it.
    pub common_cells: usize,
    /// The cells that a place which no robot has mapped would explain as well.
    unmapped_rival_cells: usize,
    words: f64,
}

impl Clue {
    /// Whether both put the camera at one spot of one session.
    fn stands_with(&self, other: &Self) -> bool {
        let both = self.stands_at.zip(other.stands_at);
        both.is_some_and(|((session, a), (of_other, b))| session == of_other && (a - b).norm() <= SAME_SPOT_M)
    }
}

impl PlaceEvidence {
    /// Sets against a place for which nothing but views speaks a rival that no robot has mapped, where so many cells of a
    /// keyframe beside it are explained elsewhere.
    pub fn set_unmapped_rival(&mut self, alike_cells: usize) {
        if !self.signs.agreeing.is_empty() {
            return;
        }
        let is_single_view =
            self.cells.iter().map(|(keyframe, ..)| keyframe).collect::<BTreeSet<_>>().len() < 2;
        let factor = if is_single_view { SINGLE_VIEW_FACTOR } else { 1.0 };
        // Saturates: the most cells there can be mean that nothing is known.
        self.unmapped_rival_cells = (alike_cells as f64 * factor) as usize;
    }

    /// Whether a view or a pose from anchors puts the camera somewhere.
    fn is_placed(&self) -> bool {
        self.pose.is_some() || !self.cells.is_empty()
    }

    /// Returns the most cells that this place explains beyond what an unmapped rival would.
    fn cells_of_its_own(&self) -> usize {
        self.common_cells.saturating_sub(self.unmapped_rival_cells)
    }
}

/// Joins views, candidates that geometry did not look at, and anchor poses to places, the most promising first.
pub fn join(searches: &[MapSearch], views: &[View]) -> Vec<PlaceEvidence> {
    let mut clues: Vec<Clue> =
        views.iter().enumerate().map(|(at, view)| of_view(searches, at, view)).collect();
    let looked_at: BTreeSet<Chosen> = views.iter().map(|view| view.chosen).collect();
    let others = ranked(searches, None).into_iter().filter(|chosen| !looked_at.contains(chosen));
    clues.extend(others.take(PLACES_MAX).map(|chosen| of_candidate(searches, chosen)));
    for (map, search) in searches.iter().enumerate() {
        clues.extend((0..search.poses.len()).map(|number| of_pose(map, search, number)));
    }
    // Stable: among equals the order is that of the ranks.
    clues.sort_by(|a, b| more_promising(figures_of_clue(a), figures_of_clue(b)));
    let mut groups: Vec<Vec<Clue>> = Vec::new();
    for clue in clues {
        let is_beside = |group: &Vec<Clue>| {
            let head = &group[0];
            let search = &searches[clue.map];
            let are_beside = |(a, b): (usize, usize)| search.are_beside(a, b);
            head.map == clue.map
                && (head.site.zip(clue.site).is_some_and(are_beside)
                    || head.stands_with(&clue)
                    || may_be_one_in_plan(search, head, &clue))
        };
        match groups.iter().position(is_beside) {
            Some(group) => groups[group].push(clue),
            None if groups.len() < PLACES_MAX => groups.push(vec![clue]),
            None => {}
        }
    }
    let mut places: Vec<PlaceEvidence> = groups.iter().map(|group| place(searches, views, group)).collect();
    places.sort_by(|a, b| more_promising(figures_of_place(a), figures_of_place(b)));
    places
}

/// Whether a clue of a plan's frame and one of a session may be of one place: the plan draws what the robots saw. They are, if
/// the session's alignment has them at one spot; and where it is not aligned, nothing tells them apart.
fn may_be_one_in_plan(search: &MapSearch, a: &Clue, b: &Clue) -> bool {
    let session = |clue: &Clue| match (clue.stands_at, clue.site) {
        (Some((session, _)), _) => Some(session),
        (None, site) => site.map(|site| search.sites[site].session),
    };
    let Some((of_a, of_b)) = session(a).zip(session(b)) else { return false };
    if search.plan_frames.contains(&of_a) == search.plan_frames.contains(&of_b) {
        return false;
    }
    let in_plan = |clue: &Clue, session: SessionSeq| {
        let plan = search.plans.get(&session)?;
        let (_, centre) = clue.stands_at?;
        Some((plan.frame, plan.plan_from_session.transform(&centre)))
    };
    match (in_plan(a, of_a), in_plan(b, of_b)) {
        (Some((frame, a)), Some((of_other, b))) => frame == of_other && (a - b).norm() <= SAME_SPOT_IN_PLAN_M,
        _ => true,
    }
}

/// Returns the sum for one place against its strongest rival. Every other place is a rival.
pub fn sum(places: &[PlaceEvidence], at: usize) -> Sum {
    let own = &places[at];
    let rivals = places.iter().enumerate().filter(|(other, _)| *other != at).map(|(_, rival)| rival);
    let against = rivals.map(|rival| {
        let names = only_of(own, rival);
        let bet = PlaceBet {
            cells: own_cells(&own.cells, &rival.cells).min(own.cells_of_its_own()),
            shared: own.signs.agreeing.len() - names.len(),
            names,
            names_of_rival: only_of(rival, own),
            differing: own.signs.contradicting as usize,
            is_placed: own.is_placed(),
        };
        bet.sum()
    });
    let unrivalled = || PlaceBet { cells: own.cells_of_its_own(), ..alone(own) }.sum();
    against.min_by_key(Sum::total).unwrap_or_else(unrivalled)
}

/// Returns the names that agree with one place and not with another.
fn only_of<'a>(place: &'a PlaceEvidence, other: &PlaceEvidence) -> Vec<&'a str> {
    let names = place.signs.agreeing.iter().filter(|name| !other.signs.agreeing.contains(name));
    names.map(String::as_str).collect()
}

/// Returns the cells that a place explains and a rival does not. Of several keyframes that ask, those at which the rival
/// explains something count, the worst of them: what was looked at for one place alone says nothing about the other.
fn own_cells(own: &Cells, rival: &Cells) -> usize {
    let count = |keyframe: usize, of: &mut dyn Iterator<Item = &(usize, i32, i32)>| {
        of.filter(|(of, ..)| *of == keyframe).count()
    };
    let keyframes = |cells: &Cells| cells.iter().map(|(keyframe, ..)| *keyframe).collect::<BTreeSet<usize>>();
    let compared = keyframes(rival);
    let only_own = compared.iter().map(|keyframe| count(*keyframe, &mut own.difference(rival))).min();
    let alone =
        || keyframes(own).into_iter().map(|keyframe| count(keyframe, &mut own.iter())).max().unwrap_or(0);
    only_own.unwrap_or_else(alone)
}

/// Returns the log-odds of one place as if there were no other.
pub fn log_odds_alone(place: &PlaceEvidence) -> LogOdds {
    alone(place).sum().total()
}

fn alone(place: &PlaceEvidence) -> PlaceBet<'_> {
    let SignEvidence { agreeing, contradicting } = &place.signs;
    bet_alone(place.common_cells, agreeing.iter(), *contradicting, place.is_placed())
}

fn bet_alone<'a>(
    cells: usize,
    names: impl Iterator<Item = &'a String>,
    differing: u32,
    is_placed: bool,
) -> PlaceBet<'a> {
    PlaceBet {
        cells,
        names: names.map(String::as_str).collect(),
        differing: differing as usize,
        is_placed,
        ..PlaceBet::default()
    }
}

/// The figures by which clues and places are put in order: log-odds by names and cells as if alone, names, cells, words.
type Figures = (LogOdds, usize, usize, f64);

fn more_promising(a: Figures, b: Figures) -> Ordering {
    (b.0, b.1, b.2).cmp(&(a.0, a.1, a.2)).then_with(|| b.3.total_cmp(&a.3))
}

fn figures_of_clue(clue: &Clue) -> Figures {
    let bet = bet_alone(clue.common_cells, clue.agreeing.iter(), clue.contradicting, true);
    (bet.sum().total(), clue.agreeing.len(), clue.common_cells, clue.words)
}

fn figures_of_place(place: &PlaceEvidence) -> Figures {
    (log_odds_alone(place), place.signs.agreeing.len(), place.common_cells, place.words)
}

fn of_view(searches: &[MapSearch], at: usize, view: &View) -> Clue {
    let clue = of_candidate(searches, view.chosen);
    let session = clue.site.map(|site| searches[clue.map].sites[site].session);
    let centre = view.pose.as_ref().map(|pose| pose.map_from_camera.centre());
    Clue { view: Some(at), common_cells: view.common_cells(), stands_at: session.zip(centre), ..clue }
}

fn of_candidate(searches: &[MapSearch], chosen: Chosen) -> Clue {
    let search = &searches[chosen.map];
    let proposed = &search.proposed[chosen.asked][chosen.candidate];
    Clue {
        map: chosen.map,
        site: Some(proposed.site),
        chosen: Some(chosen),
        agreeing: proposed.signs.agreeing.iter().cloned().collect(),
        contradicting: proposed.signs.contradicting,
        words: search.screenings[chosen.asked].candidates[chosen.candidate].candidate.bow.score,
        ..Clue::default()
    }
}

fn of_pose(map: usize, search: &MapSearch, number: usize) -> Clue {
    let (pose, site) = &search.poses[number];
    Clue {
        map,
        site: *site,
        anchor_pose: Some(number),
        stands_at: Some((pose.session, pose.pose.map_from_camera.centre())),
        agreeing: pose.identifiers.clone(),
        ..Clue::default()
    }
}

/// Sums up what speaks of one place; the first clue is the most promising one.
fn place(searches: &[MapSearch], views: &[View], group: &[Clue]) -> PlaceEvidence {
    let map = group[0].map;
    let search = &searches[map];
    let looked_at = || group.iter().filter_map(|clue| Some((clue, &views[clue.view?])));
    let verified: BTreeSet<usize> =
        looked_at().filter(|(_, view)| !view.cells.is_empty()).filter_map(|(clue, _)| clue.site).collect();
    // The best view of each keyframe that asks.
    let (mut cells, mut common_cells) = (Cells::new(), 0);
    let mut seen: BTreeSet<usize> = BTreeSet::new();
    for (_, view) in looked_at() {
        if seen.insert(view.chosen.asked) {
            cells.extend(view.cells.iter().copied());
            common_cells = view.common_cells().max(common_cells);
        }
    }
    let anchor_pose = group.iter().find_map(|clue| clue.anchor_pose);
    let best = group.iter().find(|clue| clue.chosen.is_some());
    let of_views =
        looked_at().filter_map(|(clue, view)| Some((search.sites[clue.site?].session, view.pose.clone()?)));
    let of_anchors = group.iter().filter_map(|clue| {
        let pose = &search.poses[clue.anchor_pose?].0;
        Some((pose.session, pose.pose.clone()))
    });
    // A session's frame before a plan's, for the keyframe that stands for the place is in it.
    let figures = |(session, pose): &(SessionSeq, LocatedPose)| {
        (search.plan_frames.contains(session), pose.uncertainty.translation_m)
    };
    let surest_first = |a: &(SessionSeq, LocatedPose), b: &(SessionSeq, LocatedPose)| {
        let (a, b) = (figures(a), figures(b));
        a.0.cmp(&b.0).then_with(|| a.1.total_cmp(&b.1))
    };
    let agreeing: BTreeSet<&String> = group.iter().flat_map(|clue| &clue.agreeing).collect();
    let shown = group.iter().find(|clue| clue.site.is_some());
    PlaceEvidence {
        map,
        site: shown.and_then(|clue| clue.site),
        // The site of an anchor pose lies nearest to the first keyframe's camera.
        asked: shown.and_then(|clue| clue.chosen).map_or(0, |chosen| chosen.asked),
        best: best.and_then(|clue| clue.chosen),
        view: best.and_then(|clue| clue.view),
        pose: of_views.chain(of_anchors).min_by(surest_first),
        anchor_pose,
        signs: SignEvidence {
            agreeing: agreeing.into_iter().cloned().collect(),
            contradicting: best.map_or(0, |clue| clue.contradicting),
        },
        verified_views: verified.len() as u32,
        cells,
        common_cells,
        unmapped_rival_cells: 0,
        words: group.iter().map(|clue| clue.words).fold(0.0, f64::max),
    }
}
