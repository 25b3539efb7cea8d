//! Tables: the paper's Tables II and III beside the measured figures, and one row for each kind of noise.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

use super::paper::{ORB_SLAM3_PRECISION, PrintedSequence};
use super::results::{Accuracy, ArmResult, Confusion, NEAR_M, SequenceResult, Share, WorldResult, pooled};
use super::score::Counts;
use crate::hotel::building::renumbering::{Round, Signs};
use crate::hotel::method::Method;
use crate::hotel::sensing::monocular::ScaleError;
use crate::hotel::sensing::noise::NoiseKind;

/// Returns Table II: precision and recall on each data set, by query and by the paper's unit.
pub fn table_2(results: &[SequenceResult]) -> String {
    let mut text = String::from(
        "Table II: loop closure detection, by query and by visit to a room (the paper's unit)\n\
         \n                     by query                                by visit                                printed in the paper\n\
         \x20                    precision           recall              precision           recall              precision  recall\n",
    );
    for (dataset, orb_slam3) in ORB_SLAM3_PRECISION {
        let of_dataset: Vec<&SequenceResult> =
            results.iter().filter(|r| r.printed.dataset == dataset).collect();
        if of_dataset.is_empty() {
            continue;
        }
        for arm in Method::OF_SEQUENCES {
            let counts = pooled(of_dataset.iter().map(|result| result.arms.as_slice()), arm);
            let printed = match arm {
                Method::Ours | Method::OursMonocular => String::from("      -       -"),
                Method::Paper => String::from("  100.0   100.0"),
                Method::BagOfWords => format!("{:>7.1}   100.0  (ORB-SLAM3)", 100.0 * orb_slam3),
            };
            let _ = writeln!(text, "{dataset}  {}  {printed}", accuracies(arm, &counts));
        }
    }
    text.push_str("\nin %, in brackets Wilson's interval at 95 %\n");
    text
}

/// Returns a method's columns of a table: its name, then precision and recall by query and by visit.
fn accuracies(arm: Method, counts: &[Counts; 2]) -> String {
    let [query, visit] = counts.each_ref().map(Accuracy::of);
    let shares = [query.precision, query.recall, visit.precision, visit.recall];
    format!("{:14}  {}", arm.words(), shares.each_ref().map(interval).join("  "))
}

/// Returns the caveats of Table II.
pub fn caveats(results: &[SequenceResult]) -> String {
    let mut text = String::from(
        "The paper printed its figures for a hotel of its own, which is not public. A tour comes back to one of its rooms, so that\n\
         by visit one wrong loop weighs as much as that return. Ours closes a loop that one keyframe finds. The robots of the other\n\
         two ask what ORB-SLAM3 asks before it closes one: 50 and 80 points of the candidate's surroundings, and three keyframes\n\
         that agree; so they answer fewer keyframes.\n",
    );
    for arm in Method::OF_SEQUENCES {
        let of_arm = || results.iter().filter_map(|result| arm_of(&result.arms, arm));
        let wrong: usize = of_arm().map(|result| result.wrong.len()).sum();
        let near: usize = of_arm().map(|result| result.wrong_near).sum();
        let _ = writeln!(
            text,
            "  {:14} {wrong:>5} wrong loops, {near} of them less than {NEAR_M} m from the place that was named",
            arm.words()
        );
    }
    text
}

/// Returns the figures that confuse bag of words and Sim3, on average over the sequences.
pub fn confusion(results: &[SequenceResult]) -> String {
    let mut text = String::from(
        "what confuses bag of words + Sim3: one place taken for another that is furnished alike\n",
    );
    for (dataset, _) in ORB_SLAM3_PRECISION {
        let of_dataset: Vec<&Confusion> =
            results.iter().filter(|r| r.printed.dataset == dataset).map(|r| &r.confusion).collect();
        let mean = |of: fn(&Confusion) -> f64| {
            of_dataset.iter().map(|confusion| of(confusion)).sum::<f64>() / of_dataset.len().max(1) as f64
        };
        let wrong: usize = of_dataset.iter().map(|confusion| confusion.wrong).sum();
        let _ = writeln!(
            text,
            "{dataset}  {wrong} wrong loops: words score {:.2} with {:.0} inliers; right ones {:.2} with {:.0}",
            mean(|confusion| confusion.score_of_wrong),
            mean(|confusion| confusion.inliers_of_wrong),
            mean(|confusion| confusion.score_of_right),
            mean(|confusion| confusion.inliers_of_right),
        );
    }
    text
}

/// Returns Table III: the absolute pose error of each sequence, in metres.
pub fn table_3(results: &[SequenceResult]) -> String {
    let mut text = String::from(
        "Table III: absolute pose error in metres (RMSE of positions after alignment, as evo_ape -a)\n\
         \n            measured                                    printed in the paper\n\
         sequence    ours  paper's  BoW+Sim3  odometry      ours  ORB-SLAM3  ORB-VO\n",
    );
    for result in results {
        let of = |arm: Method| arm_of(&result.arms, arm).map_or(f64::NAN, |arm| arm.absolute_pose_error_m);
        let [ours, paper, bow] = [Method::Ours, Method::Paper, Method::BagOfWords].map(of);
        let SequenceResult { sequence, odometry_m: odometry, printed, .. } = result;
        let PrintedSequence { ours_m, orb_slam3_m, orb_vo_m, .. } = printed;
        let _ = writeln!(
            text,
            "{sequence:8} {ours:7.3} {paper:8.3} {bow:9.3} {odometry:9.3} {ours_m:9.3} {orb_slam3_m:10.3} {orb_vo_m:7.3}"
        );
    }
    let mean =
        |of: &dyn Fn(&SequenceResult) -> f64| results.iter().map(of).sum::<f64>() / results.len() as f64;
    let ours_m = mean(&|r| arm_of(&r.arms, Method::Ours).map_or(f64::NAN, |arm| arm.absolute_pose_error_m));
    let (odometry_m, printed) =
        (mean(&|r| r.odometry_m), mean(&|r| r.printed.orb_vo_m) / mean(&|r| r.printed.ours_m));
    let _ = writeln!(
        text,
        "\nodometry alone is {:.1} times as far off as ours on average (the paper: {printed:.1} times)",
        odometry_m / ours_m
    );
    text
}

/// Returns the effect of each kind of noise on our method and the paper's.
pub fn noise_table(results: &[WorldResult], arms: &[Method]) -> String {
    let mut text = String::from(
        "                                                      by query                                by visit (the paper's unit)\n\
         noise                                 arm             precision           recall              precision           recall\n",
    );
    let mut row = |name: &str, arm: Method, counts: [Counts; 2]| {
        if counts[0] == Counts::default() {
            // The arm ran in none of them.
            return;
        }
        let _ = writeln!(text, "{name:37} {}", accuracies(arm, &counts));
    };
    for kind in NoiseKind::ALL {
        let of_kind: Vec<&WorldResult> = results.iter().filter(|result| result.noise == kind).collect();
        for arm in arms.iter().filter(|_| !of_kind.is_empty()) {
            row(kind.words(), *arm, pooled(of_kind.iter().map(|result| result.arms.as_slice()), *arm));
        }
    }
    let kinds: BTreeSet<NoiseKind> = pooled_worlds(results).map(|result| result.noise).collect();
    for arm in arms.iter().filter(|_| kinds.len() > 1) {
        let of_kinds = pooled_worlds(results).map(|result| result.arms.as_slice());
        row("pooled, one kind at a time", *arm, pooled(of_kinds, *arm));
    }
    text.push_str("\nin %, in brackets Wilson's interval at 95 %\n");
    text
}

/// Returns the errors of the monocular robots' lengths and positions, on average over the worlds; empty without any.
pub fn monocular(results: &[WorldResult]) -> String {
    let of_arm = |arm: Method| results.iter().filter_map(move |result| arm_of(&result.arms, arm));
    let errors: Vec<ScaleError> =
        of_arm(Method::OursMonocular).filter_map(|result| result.scale_error).collect();
    if errors.is_empty() {
        return String::new();
    }
    let mean = |of: fn(&ScaleError) -> f64| 100.0 * errors.iter().map(of).sum::<f64>() / errors.len() as f64;
    let pose_m = |arm: Method| {
        let off_m: Vec<f64> = of_arm(arm).map(|result| result.absolute_pose_error_m).collect();
        off_m.iter().sum::<f64>() / off_m.len() as f64
    };
    format!(
        "monocular: lengths scatter by {:.1} % along a tour by odometry, by {:.1} % after its loops; positions are off by {:.2} m\n\
         after alignment by scale too, those of ours with depth by {:.2} m\n",
        mean(|error| error.odometry),
        mean(|error| error.corrected),
        pose_m(Method::OursMonocular),
        pose_m(Method::Ours),
    )
}

/// Returns the pooled worlds: those with a single kind of noise, or all if there are no others.
pub fn pooled_worlds(results: &[WorldResult]) -> impl Iterator<Item = &WorldResult> {
    let is_pooled = |result: &&WorldResult| result.noise != NoiseKind::Mixed;
    let all = !results.iter().any(|result| is_pooled(&result));
    results.iter().filter(move |result| all || is_pooled(result))
}

/// Returns the true loops that our method missed, by the reason of the true candidate that came farthest.
pub fn losses<'a>(results: impl Iterator<Item = &'a [ArmResult]>) -> String {
    let (mut by_code, mut there): (BTreeMap<&str, u64>, u64) = (BTreeMap::new(), 0);
    for ours in results.filter_map(|arms| arm_of(arms, Method::Ours)) {
        there += ours.by_query.recall.whole;
        for (code, count) in &ours.lost_by {
            *by_code.entry(code).or_default() += count;
        }
    }
    let mut rows: Vec<(&str, u64)> = by_code.into_iter().collect();
    rows.sort_by_key(|(code, count)| (std::cmp::Reverse(*count), *code));
    let lost: u64 = rows.iter().map(|(_, count)| count).sum();
    let mut text =
        format!("ours did not find {lost} of {there} true loops, by the reason of the right candidate:\n");
    for (code, count) in rows {
        let _ = writeln!(text, "  {code:34} {count:>6}  {:>5.1} %", 100.0 * count as f64 / there as f64);
    }
    text
}

/// Returns our results by round, where door numbers change; otherwise empty.
pub fn rounds(results: &[WorldResult]) -> String {
    let rounds = results.iter().map(|result| result.rounds.len()).max().unwrap_or(0);
    let mut text = String::new();
    if rounds > 0 {
        text.push_str(
            "\nours, round by round: one plate in ten is new from round 2 on, those of one side from round 5 on\n\
             round   all: right of accepted, found of true   in view of new plates alone\n",
        );
    }
    for round in 0..rounds {
        let of_round = || results.iter().filter_map(|result| result.rounds.get(round));
        let sum = |of: fn(&Round) -> Counts| of_round().map(of).fold(Counts::default(), Counts::plus);
        let [all, new] = [sum(|round| round.all), sum(|round| round.at_new_plates)];
        let figures = |c: Counts| format!("{} / {}, {} / {}", c.right, c.accepted, c.found, c.with_truth);
        let _ = writeln!(text, "{:>5}   {:37}  {}", round + 1, figures(all), figures(new));
    }
    if let Some(signs) = results.iter().filter_map(|result| result.signs).reduce(Signs::plus) {
        let Signs { retired_gone, retired_hanging, retired_misread, valid_gone } = signs;
        let _ = writeln!(
            text,
            "signs at the end: {retired_gone} retired that hang there no longer, {retired_hanging} that do, \
             {retired_misread} that never did; {valid_gone} valid that hang there no longer"
        );
    }
    text
}

/// Returns the worlds in which our method was wrong, and the command to explain one; for held-out worlds only their
/// number, because they must not be inspected.
pub fn failures(results: &[WorldResult], held_out: bool) -> String {
    let wrong_in =
        |result: &WorldResult| arm_of(&result.arms, Method::Ours).map_or(0, |ours| ours.wrong.len());
    let failed = || results.iter().filter(|result| wrong_in(result) > 0);
    let mut text = format!("ours was wrong in {} of {} worlds\n", failed().count(), results.len());
    for result in failed().filter(|_| !held_out) {
        let (seed, noise) = (result.seed, result.noise.as_str());
        let option = if result.noise == NoiseKind::SecondHotel { "hotel" } else { "noise" };
        let _ = writeln!(
            text,
            "  {} times in world {seed} under {noise} (to look into it: revisit eval hotel --world {seed} --{option} {noise})",
            wrong_in(result),
        );
    }
    text
}

fn arm_of(arms: &[ArmResult], arm: Method) -> Option<&ArmResult> {
    arms.iter().find(|result| result.arm == arm)
}

fn interval(share: &Share) -> String {
    let (low, high) = share.confidence_interval;
    format!("{:5.1} [{:4.1} {:5.1}]", share.share * 100.0, low * 100.0, high * 100.0)
}
