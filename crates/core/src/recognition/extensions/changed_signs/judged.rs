//! The judgement on a sign: three passages that missed it retire it, one that reads it twice returns it.

use std::cmp::Reverse;
use std::collections::BTreeMap;

use super::passages::Passage;
use super::place::{LOOKS_OF_A_WRITE_MAX, Look, tracked_here};
use super::readings::read_otherwise;
use super::seen::{InItsPlace, in_its_place, read_alike, reads_another};
use super::split::{match_anew, split};
use crate::domain::anchor::AnchorState;
use crate::domain::change::{Change, MissedSign};
use crate::domain::event::{Event, EventKind};
use crate::domain::ids::AnchorSeq;
use crate::geometry::Point3;
use crate::recognition::map::index::{Certainty, MapIndex, MergedAnchor};
use crate::recognition::map::recorder::{Decided, Recorder};

/// Passages that must have missed a sign.
pub const MISSING_PASSAGES: usize = 3;
/// Keyframes of one passage that must read a retired sign as it was called.
pub const RETURNING_READS: usize = 2;
/// Keyframes of one passage that must have had a sign clearly in view where nothing hangs in its place: a detector overlooks
/// signs.
pub const CLEAR_VIEWS: usize = 2;
/// Passages that missed a sign and are kept. Beyond them the oldest goes.
pub const MISSES_KEPT: usize = 8;

/// Returns what geometry is to look at to find the place of each passage; nothing where the passage is judged without it.
pub fn looks(index: &MapIndex, passages: &[Passage]) -> Vec<Vec<Look>> {
    let mut left = LOOKS_OF_A_WRITE_MAX;
    let looks = |passage| {
        if read_alike(index, passage) > 0 || !may_have_missed(index, passage) || tracked_here(index, passage)
        {
            return Vec::new();
        }
        let looks = Look::all(index, passage, left);
        left -= looks.len();
        looks
    };
    passages.iter().map(looks).collect()
}

/// Judges the signs of passages; `places` has where each sign would hang, as geometry found it, if it did.
pub fn judge(index: &mut MapIndex, passages: &[Passage], places: &[Option<Point3>]) -> Option<Decided> {
    let mut record = Recorder::new(index);
    for (passage, found) in passages.iter().zip(places) {
        let index = record.index();
        let reads = read_alike(index, passage);
        if reads > 0 {
            see_again(&mut record, passage, reads);
        } else if may_have_missed(index, passage) {
            let place = if tracked_here(index, passage) { Some(passage.sign.centre) } else { *found };
            if let Some(place) = place {
                miss(&mut record, passage, &place);
            }
        }
    }
    let decided = record.finish();
    (!decided.changes.is_empty()).then_some(decided)
}

/// The passage saw the sign as it is called, in so many keyframes.
fn see_again(record: &mut Recorder<'_>, passage: &Passage, reads: usize) {
    let (index, root) = (record.index(), passage.sign.root);
    let Some(object) = index.objects().get(root) else { return };
    let members = object.members.clone();
    let mut changes = Vec::new();
    let returns = object.state == AnchorState::Retired && reads >= RETURNING_READS;
    if returns {
        changes.extend(members.iter().copied().map(Change::SignReturned));
    }
    if index.misses_of(object).next().is_some() {
        changes.extend(members.into_iter().map(Change::MissesWithdrawn));
    }
    if !changes.is_empty() {
        record.touch([root]);
        record.apply(changes);
    }
    if returns {
        match_anew(record, root);
    }
}

/// Whether a passage that did not read a sign as it is called may have missed it, wherever it was.
fn may_have_missed(index: &MapIndex, passage: &Passage) -> bool {
    let object = index.objects().get(passage.sign.root);
    let hangs = object.is_some_and(|object| object.state != AnchorState::Retired);
    hangs && (clear_views(passage) >= CLEAR_VIEWS || reads_another(index, passage))
}

/// The passage was there and did not see the sign as it is called; `place` is where it would hang.
fn miss(record: &mut Recorder<'_>, passage: &Passage, place: &Point3) {
    let root = passage.sign.root;
    let keyframe = passage.expecting.first().map(|expecting| expecting.keyframe);
    let other = match in_its_place(record.index(), passage, place) {
        InItsPlace::Other(other) => Some(Some(other)),
        InItsPlace::Nothing if clear_views(passage) >= CLEAR_VIEWS => Some(None),
        InItsPlace::Nothing | InItsPlace::Unread => None,
    };
    if let Some((keyframe, other)) = keyframe.zip(other) {
        record.apply(vec![Change::SignMissed(MissedSign { anchor: root, keyframe, other })]);
        record.touch([root]);
        retire(record, passage);
    }
}

fn clear_views(passage: &Passage) -> usize {
    passage.expecting.iter().filter(|expecting| expecting.is_clear).count()
}

/// Retires a sign that enough passages have missed.
fn retire(record: &mut Recorder<'_>, passage: &Passage) {
    let (index, root) = (record.index(), passage.sign.root);
    let Some(object) = index.objects().get(root) else { return };
    let misses: Vec<MissedSign> = index.misses_of(object).collect();
    let Some(in_place) = replacement(index, object, &misses) else {
        keep_newest(record, root, &misses);
        return;
    };
    let members = object.members.clone();
    let described = object.description.as_ref().map(|description| description.raw.to_string());
    let mut event = Event::of(EventKind::AnchorRetired);
    event.keyframe = (misses.iter().map(|missed| missed.keyframe).max())
        .and_then(|keyframe| Some(index.keyframe(keyframe)?.id.clone()));
    let (replaced_by, is_new) = match in_place {
        Replacement::Nothing => (None, false),
        Replacement::By(other) => (Some(other), false),
        Replacement::Itself(gist) => (split(record, passage, &gist), true),
    };
    (event.anchor, event.other, event.detail) = (Some(root), replaced_by, described);
    let changes = members
        .iter()
        .flat_map(|member| [Change::MissesWithdrawn(*member), Change::SignRetired(*member, replaced_by)]);
    record.apply(changes.collect());
    record.emit(event);
    if let Some(new) = replaced_by.filter(|_| is_new) {
        match_anew(record, new);
    }
}

/// Keeps as many of the passages that missed a sign as may decide.
fn keep_newest(record: &mut Recorder<'_>, root: AnchorSeq, misses: &[MissedSign]) {
    if misses.len() <= MISSES_KEPT {
        return;
    }
    let members = record.index().objects().get(root).map(|object| object.members.clone()).unwrap_or_default();
    let mut newest = misses.to_vec();
    newest.sort_by_key(|missed| Reverse(missed.keyframe));
    newest.truncate(MISSES_KEPT);
    let withdrawn = members.into_iter().map(Change::MissesWithdrawn);
    record.apply(withdrawn.chain(newest.into_iter().map(Change::SignMissed)).collect());
}

/// The thing that hangs where a retired sign hung.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Replacement {
    /// Nothing.
    Nothing,
    /// The sign of another anchor.
    By(AnchorSeq),
    /// A sign that fed its own anchor, by the gist of what was read.
    Itself(String),
}

/// Returns what hangs in a sign's place, if enough passages say that the sign does not.
///
/// A sign that a passage read otherwise counts if it is sure: described, or read alike in another passage, too.
fn replacement(index: &MapIndex, object: &MergedAnchor, misses: &[MissedSign]) -> Option<Replacement> {
    let empty = misses.iter().filter(|missed| missed.other.is_none()).count();
    // The passages that read each text, whether it is described, and the newest anchor that it fed.
    let mut by_text: BTreeMap<String, (usize, bool, AnchorSeq)> = BTreeMap::new();
    for (missed, other) in misses.iter().filter_map(|missed| Some((missed, missed.other?))) {
        let Some((gist, is_sure)) = text_of(index, object, missed, other) else { continue };
        let (passages, is_described, newest) = by_text.entry(gist).or_insert((0, false, other));
        *passages += 1;
        *is_described |= is_sure;
        *newest = other.max(*newest);
    }
    let sure = by_text.into_iter().filter(|(_, (passages, is_described, _))| *passages > 1 || *is_described);
    let most = sure.max_by_key(|(_, (passages, _, newest))| (*passages, *newest));
    let Some((gist, (passages, _, newest))) = most else {
        return (empty >= MISSING_PASSAGES).then_some(Replacement::Nothing);
    };
    if empty + passages < MISSING_PASSAGES {
        return None;
    }
    Some(match index.objects().root(newest) {
        Some(_) if object.members.contains(&newest) => Replacement::Itself(gist),
        Some(root) => Replacement::By(root),
        None => Replacement::Nothing,
    })
}

/// Returns the gist of what a passage read in a sign's place, and whether a model or somebody described it.
fn text_of(
    index: &MapIndex,
    object: &MergedAnchor,
    missed: &MissedSign,
    other: AnchorSeq,
) -> Option<(String, bool)> {
    if !object.members.contains(&other) {
        let description = index.object_of(other)?.description.as_ref()?;
        return Some((description.text.gist().to_owned(), description.certainty == Certainty::Sure));
    }
    let read = index.anchor(other)?.observations.values().filter_map(|seen| {
        Some((seen.keyframe.0.abs_diff(missed.keyframe.0), read_otherwise(index, object, seen)?))
    });
    let (_, text) = read.min_by_key(|(apart, _)| *apart)?;
    Some((text.gist().to_owned(), false))
}
