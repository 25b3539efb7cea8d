//! The frames of a map's sessions, from its facts.

use std::collections::{BTreeMap, BTreeSet};

use super::consensus::{COMPARED_MAX, Consensus, consensus};
use super::cycle::Joined;
use super::measurement::{Measurement, Place};
use super::refinement::{Joint, WEIGHT_MIN, refine};
use super::tree::{Pair, Placed, tree};
use crate::domain::fleet_frames::{FleetFrames, FramedSession, Suspect};
use crate::domain::ids::SessionSeq;
use crate::geometry::{Point3, Pose};
use crate::recognition::map::index::MapIndex;
use crate::recognition::plans::alignments::Alignments;

/// Standard deviations that an alignment to a plan may be off.
const PLAN_SIGMAS: f64 = 3.0;

/// The facts that the frames of a map's sessions follow from.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    sessions: Vec<SessionSeq>,
    /// Measurements between two sessions, by loops and plans, the older session first.
    between: Vec<Measurement>,
    /// Measurements within one session.
    within: Vec<Measurement>,
    /// Loops between two sessions that say nothing.
    left_out: usize,
}

/// Reads what the frames follow from. In a map that is not metric nothing does, for nothing says how the lengths of sessions compare.
pub fn measured(index: &MapIndex) -> Measured {
    let sessions = sessions(index);
    let mut measured =
        Measured { between: plans(index, &sessions), within: Vec::new(), left_out: 0, sessions };
    for closed in index.loops().values() {
        let ends = [closed.keyframe, closed.candidate].map(|seq| index.session_of(seq));
        let [Some(keyframe), Some(candidate)] = ends else { continue };
        let transform = closed.candidate_from_query.filter(|_| index.properties().metric);
        match transform.and_then(|transform| Measurement::of_loop(index, closed, &transform)) {
            Some(one) if one.a == one.b => measured.within.push(one),
            Some(one) => measured.between.push(older_first(one)),
            None => measured.left_out += usize::from(keyframe != candidate),
        }
    }
    measured
}

/// Computes the frames of a map's sessions.
pub fn fleet_frames(facts: &Measured) -> FleetFrames {
    let Measured { sessions, between: measured, within, left_out } = facts;
    let pairs = pairs(measured);
    let mut placed = tree(sessions, measured, &pairs);
    let middles = middles(measured, &pairs);
    let decided: Vec<Pair> = pairs.iter().filter(|(_, of)| !of.is_tie).map(|(pair, _)| *pair).collect();
    let joints: Vec<Joint<'_>> = decided.iter().map(|pair| joint(measured, &pairs[pair], &middles)).collect();
    let weights = refine(&mut placed, &joints);
    let holding: BTreeSet<Pair> = decided
        .into_iter()
        .zip(weights)
        .filter(|(_, weight)| *weight >= WEIGHT_MIN)
        .map(|(pair, _)| pair)
        .collect();
    let counts = counts(measured, &pairs, &placed, &holding);
    let suspects = suspects(measured, within, &placed, &counts);
    let counting = || measured.iter().zip(&counts).filter(|(_, counts)| **counts).map(|(one, _)| one);
    FleetFrames {
        sessions: sessions.iter().map(|session| framed(*session, &placed, counting())).collect(),
        loops: counting().filter(|one| one.loop_id.is_some()).count(),
        suspects,
        left_out: *left_out,
    }
}

/// Returns the sessions that have keyframes or are a plan's frame, in order of appearance.
fn sessions(index: &MapIndex) -> Vec<SessionSeq> {
    let driven = index.keyframes().map(|keyframe| keyframe.session);
    let frames = index.priors().frames().filter(|(_, anchors)| !anchors.is_empty()).map(|(frame, _)| frame);
    driven.chain(frames).collect::<BTreeSet<SessionSeq>>().into_iter().collect()
}

/// Returns what plans say of the sessions that are aligned to them.
fn plans(index: &MapIndex, sessions: &[SessionSeq]) -> Vec<Measurement> {
    let mut alignments = Alignments::of(index);
    let mut plans = Vec::new();
    for session in sessions {
        let Some(found) = alignments.session(*session) else { continue };
        let centres =
            index.keyframes().filter(|of| of.session == *session).map(|of| of.map_from_camera.centre());
        let middle = mean(centres);
        let place = |at| Place { at, milestone: None };
        plans.push(older_first(Measurement {
            loop_id: None,
            a: found.frame,
            b: *session,
            a_from_b: found.plan_from_session,
            at_a: place(found.plan_from_session.transform(&middle)),
            at_b: place(middle),
            slack_m: PLAN_SIGMAS * found.position_sigma_m,
            slack_rad: PLAN_SIGMAS * found.yaw_sigma_rad,
            drift_share: index.properties().settings.odometry_max_drift_share,
        }));
    }
    plans
}

fn older_first(one: Measurement) -> Measurement {
    if one.a < one.b { one } else { one.reversed() }
}

fn mean(points: impl Iterator<Item = Point3>) -> Point3 {
    let (mut sum, mut count) = (nalgebra::Vector3::zeros(), 0_u32);
    for point in points {
        sum += point.coords;
        count += 1;
    }
    Point3::from(sum / f64::from(count.max(1)))
}

fn pairs(measured: &[Measurement]) -> BTreeMap<Pair, Consensus> {
    let mut numbers: BTreeMap<Pair, Vec<usize>> = BTreeMap::new();
    for (number, one) in measured.iter().enumerate() {
        numbers.entry((one.a, one.b)).or_default().push(number);
    }
    let agreed = |(pair, numbers): (Pair, Vec<usize>)| Some((pair, consensus(measured, &numbers)?));
    numbers.into_iter().filter_map(agreed).collect()
}

/// Returns for each session the places where its loops with the others were closed, one for each other session.
fn middles(measured: &[Measurement], pairs: &BTreeMap<Pair, Consensus>) -> BTreeMap<SessionSeq, Vec<Place>> {
    let mut middles: BTreeMap<SessionSeq, Vec<Place>> = BTreeMap::new();
    for of in pairs.values().filter(|of| !of.is_tie) {
        let one = &measured[of.middle];
        middles.entry(one.a).or_default().push(one.at_a);
        middles.entry(one.b).or_default().push(one.at_b);
    }
    middles
}

/// Returns the agreeing loops of a pair. They may be off by what either session drifted, on the average, from where its loops with the
/// others were closed.
fn joint<'m>(
    measured: &'m [Measurement],
    of: &Consensus,
    middles: &BTreeMap<SessionSeq, Vec<Place>>,
) -> Joint<'m> {
    let middle = &measured[of.middle];
    let mean_way_m = |session: SessionSeq, from: &Place| {
        let others = middles.get(&session).map_or(&[][..], Vec::as_slice);
        others.iter().map(|other| from.way_to_m(other)).sum::<f64>() / others.len().max(1) as f64
    };
    let way_m = mean_way_m(middle.a, &middle.at_a) + mean_way_m(middle.b, &middle.at_b);
    Joint {
        measurements: of.agreeing.iter().map(|number| &measured[*number]).collect(),
        allowed_m: middle.drift_share.mul_add(way_m, middle.slack_m),
        allowed_rad: middle.slack_rad,
    }
}

/// Returns which measurements count: those that agree with the others between their sessions, and with the cycles.
fn counts(
    measured: &[Measurement],
    pairs: &BTreeMap<Pair, Consensus>,
    placed: &BTreeMap<SessionSeq, Placed>,
    holding: &BTreeSet<Pair>,
) -> Vec<bool> {
    let count = |(number, one): (usize, &Measurement)| {
        let pair = (one.a, one.b);
        if holding.contains(&pair) {
            return pairs[&pair].agreeing.binary_search(&number).is_ok();
        }
        // Nobody could tell, or the cycles contradict those that agree: then the frames decide, where there are some.
        let Some(a_from_b) = between(placed, one) else { return false };
        let (off_m, off_rad) = one.off(&a_from_b);
        off_m <= one.allowed_m(&measured[pairs[&pair].middle]) && off_rad <= one.slack_rad
    };
    measured.iter().enumerate().map(count).collect()
}

/// Returns where the frames have the two sessions of a measurement to each other; none if nothing joins them.
fn between(placed: &BTreeMap<SessionSeq, Placed>, one: &Measurement) -> Option<Pose> {
    let (a, b) = (placed.get(&one.a)?, placed.get(&one.b)?);
    (a.root == b.root).then(|| a.root_from_session.inverse().after(&b.root_from_session))
}

fn suspects(
    measured: &[Measurement],
    within: &[Measurement],
    placed: &BTreeMap<SessionSeq, Placed>,
    counts: &[bool],
) -> Vec<Suspect> {
    let joined = Joined::of(measured.iter().zip(counts).filter(|(_, counts)| **counts).map(|(one, _)| one));
    let doubtful: Vec<&Measurement> =
        measured.iter().zip(counts).filter(|(_, counts)| !**counts).map(|(one, _)| one).collect();
    let mut suspects = Vec::new();
    for one in &doubtful {
        let Some(loop_id) = one.loop_id.clone() else { continue };
        if let Some(a_from_b) = between(placed, one) {
            let (off_m, off_rad) = one.off(&a_from_b);
            suspects.push(Suspect { loop_id, cycle: joined.cycle(one), off_m, off_rad });
            continue;
        }
        // Nothing joins the two: it contradicts another between them, and that one it.
        let others = doubtful.iter().filter(|rival| (rival.a, rival.b) == (one.a, one.b)).take(COMPARED_MAX);
        let rival = others.copied().find(|rival| rival.loop_id != one.loop_id && !rival.agrees(one));
        let (off_m, off_rad) = rival.map_or((0.0, 0.0), |rival| one.off(&rival.a_from_b));
        let cycle = rival.and_then(|rival| rival.loop_id.clone()).into_iter().collect();
        suspects.push(Suspect { loop_id, cycle, off_m, off_rad });
    }
    suspects.extend(within.iter().filter_map(contradicts_tracking));
    suspects.sort_by(|a, b| a.loop_id.cmp(&b.loop_id));
    suspects
}

/// Returns the suspect that a loop within one session is if it contradicts the way that was driven from the one keyframe to the other.
fn contradicts_tracking(one: &Measurement) -> Option<Suspect> {
    let way_m = one.at_a.milestone?.way_to_m(&one.at_b.milestone?)?;
    let allowed_m = one.drift_share.mul_add(way_m, one.slack_m);
    let (off_m, off_rad) = one.off(&Pose::identity());
    let loop_id = one.loop_id.clone().filter(|_| off_m > allowed_m || off_rad > one.slack_rad)?;
    Some(Suspect { loop_id, cycle: Vec::new(), off_m, off_rad })
}

fn framed<'m>(
    session: SessionSeq,
    placed: &BTreeMap<SessionSeq, Placed>,
    counting: impl Iterator<Item = &'m Measurement>,
) -> FramedSession {
    let alone = Placed { root: session, root_from_session: Pose::identity() };
    let Placed { root, root_from_session } = placed.get(&session).copied().unwrap_or(alone);
    let own = counting.filter(|one| one.loop_id.is_some() && (one.a == session || one.b == session));
    let squares: Vec<f64> = own.filter_map(|one| Some(one.off(&between(placed, one)?).0.powi(2))).collect();
    let loops = squares.len();
    let residual_m = (loops > 0).then(|| (squares.iter().sum::<f64>() / loops as f64).sqrt());
    FramedSession { session, root, root_from_session, residual_m, loops }
}
