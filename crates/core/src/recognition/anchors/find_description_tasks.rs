//! The search for description tasks: what a map's anchors lack and a model could give (§IV-A.3, §IV-B).

use std::collections::{BTreeMap, HashSet};

use super::description_tasks::{DescriptionTask, DescriptionTasks};
use super::pairs::{Embeddings, Settled, pairs};
use crate::domain::anchor::{AnchorState, Observation};
use crate::domain::ids::{AnchorSeq, SessionSeq};
use crate::domain::roles::Roles;
use crate::recognition::map::index::{MapIndex, MergedAnchor};
use crate::semantics::{self, Numbering, Text};

/// A crop replaces the one described before when its area is this many times as large.
pub(in crate::recognition) const BETTER_CROP: f64 = 2.0;

/// Returns at most `max` description tasks, descriptions first, the oldest anchor first. `passed_over` tells what is
/// under way or has failed lately; `embeddings` are those at hand, if a model makes some.
pub fn find_description_tasks(
    index: &MapIndex,
    roles: Roles,
    embeddings: Option<&dyn Embeddings>,
    settled: &mut Settled,
    max: usize,
    passed_over: impl Fn(&DescriptionTask) -> bool,
) -> DescriptionTasks {
    let mut found = Vec::new();
    let mut is_all = true;
    if roles.vision {
        let latest = latest_stamps(index);
        let readings = index.objects().iter().filter_map(|(_, object)| reading(index, object, &latest));
        found.extend(readings.filter(|lack| !passed_over(lack)).take(max));
    }
    if roles.text {
        let texts = index.objects().iter().flat_map(|(_, object)| of_object(index, object));
        let left = max - found.len();
        let mut seen = HashSet::new();
        found.extend(texts.filter(|lack| !passed_over(lack) && seen.insert(lack.clone())).take(left));
        is_all = pairs(index, embeddings, settled, max, &mut found, passed_over);
    }
    is_all &= found.len() < max;
    DescriptionTasks { found, is_all }
}

/// Returns the clock of each session: its newest keyframe, in seconds.
fn latest_stamps(index: &MapIndex) -> BTreeMap<SessionSeq, i64> {
    let mut latest = BTreeMap::new();
    for keyframe in index.keyframes() {
        let newest = latest.entry(keyframe.session).or_insert(keyframe.stamp.sec);
        *newest = keyframe.stamp.sec.max(*newest);
    }
    latest
}

/// Returns the crop of an object to be read next, if there is one.
fn reading(
    index: &MapIndex,
    object: &MergedAnchor,
    latest: &BTreeMap<SessionSeq, i64>,
) -> Option<DescriptionTask> {
    let is_by_hand = object.description.as_ref().is_some_and(|description| description.by_hand);
    if is_by_hand || object.state == AnchorState::Retired {
        return None;
    }
    let settings = &index.properties().settings;
    let with_crop: Vec<(AnchorSeq, &Observation)> = (object.members.iter())
        .filter_map(|member| Some((*member, index.anchor(*member)?)))
        .flat_map(|(member, anchor)| anchor.observations.values().map(move |seen| (member, seen)))
        .filter(|(_, seen)| seen.crop_area_px.is_some())
        .collect();
    let area = |seen: &Observation| seen.crop_area_px.unwrap_or(0.0);
    let is_read = |seen: &Observation| seen.crop_reading.as_ref().is_some_and(|read| !read.degraded);
    let read: Vec<&Observation> =
        with_crop.iter().map(|(_, seen)| *seen).filter(|seen| is_read(seen)).collect();
    if read.is_empty() && object.state == AnchorState::Valid && !has_degraded(&with_crop) {
        // What the client read says enough.
        return None;
    }
    let numbering = index.readings().numbering(index.class_of(object));
    // A detection whose own text says enough is not read again.
    let says_enough = |seen: &Observation| {
        let told = seen.reading.as_deref().map(|reading| Text::under(reading, numbering).information_level());
        told.is_some_and(|level| u32::from(level) >= settings.description_min_information_level)
    };
    let open = || with_crop.iter().copied().filter(|(_, seen)| !is_read(seen) && !says_enough(seen));
    let is_large = |seen: &Observation| area(seen) >= settings.description_min_crop_area_px;
    let refresh_s = settings.description_refresh_s;
    let (anchor, best) = if read.is_empty() {
        let waited = |seen: &Observation| waited_s(index, seen, latest) >= refresh_s;
        let ripe = open().any(|(_, seen)| is_large(seen) || waited(seen));
        largest_of(open()).filter(|_| ripe)?
    } else {
        let largest_read = read.iter().map(|seen| area(seen)).fold(0.0, f64::max);
        let newest_read = read.iter().map(|seen| stamp_s(index, seen)).fold(f64::NEG_INFINITY, f64::max);
        let tells_more = |seen: &Observation| {
            is_large(seen)
                && (area(seen) >= BETTER_CROP * largest_read
                    || !agrees(object, numbering, read.len(), settings.agreeing_reads))
        };
        // A larger crop that is older than the last reading refreshes nothing, so each question has its own crop.
        let refreshes = |seen: &Observation| stamp_s(index, seen) - newest_read >= refresh_s;
        largest_of(open())
            .filter(|(_, seen)| tells_more(seen))
            .or_else(|| largest_of(open().filter(|(_, seen)| refreshes(seen))))?
    };
    let hint = best.reading.clone();
    Some(DescriptionTask::Reading {
        anchor,
        keyframe: best.keyframe,
        detection: best.detection,
        class: index.class_of(object).into(),
        hint,
    })
}

/// Returns the observation with the largest crop; of equals, the newest.
fn largest_of<'a>(
    seen: impl Iterator<Item = (AnchorSeq, &'a Observation)>,
) -> Option<(AnchorSeq, &'a Observation)> {
    let area = |seen: &Observation| seen.crop_area_px.unwrap_or(0.0);
    seen.max_by(|(_, a), (_, b)| {
        area(a).total_cmp(&area(b)).then_with(|| (a.keyframe, a.detection).cmp(&(b.keyframe, b.detection)))
    })
}

fn has_degraded(with_crop: &[(AnchorSeq, &Observation)]) -> bool {
    with_crop.iter().any(|(_, seen)| seen.crop_reading.as_ref().is_some_and(|read| read.degraded))
}

/// Whether enough of the readings agree, or enough were taken to leave it at that.
fn agrees(object: &MergedAnchor, numbering: Option<&Numbering>, reads: usize, agreeing_reads: u32) -> bool {
    let wanted = agreeing_reads as usize;
    let told: Vec<(Text, usize)> =
        object.votes.described().map(|(text, count)| (Text::under(text, numbering), count)).collect();
    let alike = told.first().map_or(0, |(first, _)| {
        let same = |(text, _): &&(Text, usize)| semantics::similarity_level(first, text).0 >= 4;
        told.iter().filter(same).map(|(_, count)| count).sum()
    });
    alike >= wanted || reads > 2 * wanted
}

fn stamp_s(index: &MapIndex, seen: &Observation) -> f64 {
    index.keyframe(seen.keyframe).map_or(0.0, |keyframe| keyframe.stamp.sec as f64)
}

fn waited_s(index: &MapIndex, seen: &Observation, latest: &BTreeMap<SessionSeq, i64>) -> f64 {
    let session = index.session_of(seen.keyframe);
    let now = session.and_then(|session| latest.get(&session)).copied().unwrap_or_default();
    now as f64 - stamp_s(index, seen)
}

/// Returns what is open about the text of one object.
fn of_object<'a>(
    index: &'a MapIndex,
    object: &'a MergedAnchor,
) -> impl Iterator<Item = DescriptionTask> + 'a {
    let class = index.class_of(object);
    let called = object.description.as_ref().filter(|description| !description.by_hand);
    let information = called.and_then(|description| {
        let text = &description.text;
        let open =
            semantics::information_is_open(text) && index.verdicts().information(class, text).is_none();
        open.then(|| DescriptionTask::Information { class: class.into(), text: text.normalised().into() })
    });
    let described = called.filter(|_| !index.readings().is_of_codes(class));
    let merge = described.and_then(|_| object.votes.to_merge()).and_then(|(first, second)| {
        let (a, b) = if first <= second { (first, second) } else { (second, first) };
        if index.verdicts().merged(class, a, b).is_some() {
            return None;
        }
        match describe_one(index, class, a, b) {
            None => {
                return Some(DescriptionTask::Similarity { class: class.into(), a: a.into(), b: b.into() });
            }
            Some(false) => return None,
            Some(true) => {}
        }
        let as_read = [object.votes.as_read(a)?, object.votes.as_read(b)?].map(Into::into);
        Some(DescriptionTask::Merge { class: class.into(), a: a.into(), b: b.into(), as_read })
    });
    information.into_iter().chain(merge)
}

/// Whether both texts describe one object, and each say something that the other does not. `None` if a model is to tell.
fn describe_one(index: &MapIndex, class: &str, a: &str, b: &str) -> Option<bool> {
    let merged = semantics::merge(a, b);
    if merged == a || merged == b {
        return Some(false);
    }
    let (of_a, of_b) = (Text::parse(a), Text::parse(b));
    let level = match semantics::route_similarity(&of_a, &of_b) {
        semantics::Route::Decided(judgement) => judgement.level,
        semantics::Route::Open(_) => index.verdicts().similarity(class, &of_a, &of_b)?.0,
    };
    Some(level >= 4)
}
