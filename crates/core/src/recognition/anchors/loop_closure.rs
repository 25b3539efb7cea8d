//! A loop is closed, or taken back: matched anchors merge, or part again (§IV-C.2).

use crate::domain::change::{Change, Loop, Merge, MergeCause};
use crate::domain::event::{Event, EventKind};
use crate::domain::ids::{AnchorSeq, KeyframeSeq, LoopId};
use crate::domain::loop_warning::LoopWarning;
use crate::domain::method::Method;
use crate::domain::settings::Settings;
use crate::recognition::extensions::distinctiveness::PlaceCounts;
use crate::recognition::extensions::loop_warning::loop_warning;
use crate::recognition::loops::anchor_map::local_anchor_map;
use crate::recognition::loops::centre::Centre;
use crate::recognition::loops::comparison::{Matched, compare};
use crate::recognition::map::index::{MapIndex, MergedAnchor};
use crate::recognition::map::recorder::{Decided, Recorder};

/// Closes a loop: merges the pairs that match between the two local anchor maps, one-to-one
/// whatever the map's reading of Eq. (2) is (three EXIT signs are not one), and makes the two
/// keyframes covisible (M12). Returns what speaks against it, if anything does.
pub fn close_loop(index: &mut MapIndex, closed: Loop) -> (Option<LoopWarning>, Decided) {
    let warning = loop_warning(index, &closed);
    let mut record = Recorder::new(index);
    let mut event = Event::of(EventKind::LoopConfirmed);
    event.loop_id = Some(closed.id.clone());
    event.keyframe = Some(closed.keyframe_id.clone());
    event.candidate = Some(closed.candidate_id.clone());
    event.query.clone_from(&closed.query);
    event.detail = warning.as_ref().map(|warning| warning.detail.clone());
    record.emit(event);
    // What matches is asked before the loop joins the two neighbourhoods.
    let pairs = matched_objects(record.index(), &closed);
    record.apply(vec![Change::LoopAdded(closed.clone())]);
    merge_pairs(&mut record, &closed, pairs);
    (warning, record.finish())
}

/// Merges the matched pairs. Two that another loop has made one object already are linked all the same, from the
/// anchor seen around one keyframe to the one seen around the other: should that loop be revoked, this one holds.
fn merge_pairs(record: &mut Recorder<'_>, closed: &Loop, pairs: Vec<(AnchorSeq, AnchorSeq)>) {
    for (a, b) in pairs {
        let index = record.index();
        let (Some(mut a), Some(mut b)) = (index.objects().root(a), index.objects().root(b)) else { continue };
        if a == b {
            let around = |keyframe| index.objects().get(a).and_then(|o| member_around(index, o, keyframe));
            let (Some(here), Some(there)) = (around(closed.keyframe), around(closed.candidate)) else {
                continue;
            };
            (a, b) = (here, there);
        }
        if a == b {
            continue;
        }
        let merge = Merge { into: a.min(b), from: a.max(b), cause: MergeCause::Loop(closed.id.clone()) };
        record.merge(merge, |event| event.loop_id = Some(closed.id.clone()));
    }
}

/// Returns the anchor of an object that this keyframe, or one it passes with, has seen itself.
fn member_around(index: &MapIndex, object: &MergedAnchor, keyframe: KeyframeSeq) -> Option<AnchorSeq> {
    let passes = |seen_by| seen_by == keyframe || index.covisibility().joins_by_sight(keyframe, seen_by);
    let members = object.members.iter().copied();
    members
        .into_iter()
        .find(|member| index.anchor(*member).is_some_and(|anchor| anchor.keyframes().any(passes)))
}

fn matched_objects(index: &MapIndex, closed: &Loop) -> Vec<(AnchorSeq, AnchorSeq)> {
    let mut places = PlaceCounts::default();
    let centres = Centre::stored(index, closed.keyframe).zip(Centre::stored(index, closed.candidate));
    let Some((query, candidate)) = centres else { return Vec::new() };
    let query = local_anchor_map(index, &query, &mut places);
    let candidate = local_anchor_map(index, &candidate, &mut places);
    let settings = Settings { method: Method::Revisit, ..index.properties().settings.clone() };
    let comparison = compare(&query, &candidate, index, &settings);
    let objects = |pair: &Matched<'_>| pair.query.name.object().zip(pair.candidate.name.object());
    comparison.matches.iter().filter_map(objects).collect()
}

/// Takes a loop back: what it merged parts again, unless another loop that still stands matches it too.
pub fn revoke_loop(index: &mut MapIndex, id: &LoopId) -> (Vec<Merge>, Decided) {
    let made = index.objects().links_of_loop(id);
    let mut record = Recorder::new(index);
    let mut event = Event::of(EventKind::LoopRevoked);
    event.loop_id = Some(id.clone());
    if let Some(closed) = record.index().loops().get(id) {
        event.keyframe = Some(closed.keyframe_id.clone());
        event.candidate = Some(closed.candidate_id.clone());
    }
    record.emit(event);
    record.touch(made.iter().flat_map(|merge| [merge.into, merge.from]));
    record.apply(vec![Change::LoopRemoved(id.clone())]);
    let objects = record.index().objects();
    let is_parted = |merge: &Merge| objects.root(merge.into) != objects.root(merge.from);
    (made.into_iter().filter(is_parted).collect(), record.finish())
}
