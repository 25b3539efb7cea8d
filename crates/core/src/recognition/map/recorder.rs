//! Decisions in steps: each step's changes are applied before the next step looks.

use std::collections::BTreeSet;

use super::index::MapIndex;
use crate::domain::change::{Change, Keyframe, Merge};
use crate::domain::event::{Event, EventKind};
use crate::domain::former::FormerValues;
use crate::domain::ids::{AnchorSeq, KeyframeSeq, SessionSeq};
use crate::domain::session_merge::MergeUndo;

/// What a request changed, and what there is to tell about it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Decided {
    /// The changes, already applied to the index; the store must commit them all or none.
    pub changes: Vec<Change>,
    /// What happened, for those who listen.
    pub events: Vec<Event>,
    /// The values that the changes replaced, where the map keeps its history.
    pub former: FormerValues,
}

/// Applies changes to an index and keeps them for the store.
pub struct Recorder<'a> {
    index: &'a mut MapIndex,
    decided: Decided,
    touched: BTreeSet<AnchorSeq>,
    /// Whether a keyframe arrives: the points that it brings are its own, and replace nothing.
    keyframe_arrives: bool,
    /// Whether the values that are replaced are kept though the map keeps no history.
    keeps_former: bool,
    /// Sessions that a change writes in.
    written: BTreeSet<SessionSeq>,
    /// The values that revoke the merge of sessions that this request is.
    undo: Option<Box<MergeUndo>>,
}

impl<'a> Recorder<'a> {
    /// Starts a request.
    pub fn new(index: &'a mut MapIndex) -> Self {
        Self {
            index,
            decided: Decided::default(),
            touched: BTreeSet::new(),
            keyframe_arrives: false,
            keeps_former: false,
            written: BTreeSet::new(),
            undo: None,
        }
    }

    /// Starts a request that can be taken back: the values that it replaces are kept, whether the map keeps its history or not.
    pub fn keeping_former(index: &'a mut MapIndex) -> Self {
        Self { keeps_former: true, ..Self::new(index) }
    }

    /// Returns the changes so far.
    pub fn changes(&self) -> &[Change] {
        &self.decided.changes
    }

    /// Returns the map as it stands after the steps so far.
    pub fn index(&self) -> &MapIndex {
        self.index
    }

    /// Applies one step's changes.
    pub fn apply(&mut self, changes: Vec<Change>) {
        if self.keeps_former || self.index.properties().settings.keep_history {
            for change in &changes {
                self.keep_former(change);
            }
        }
        if !self.index.open_merges().is_empty() {
            let written = changes.iter().flat_map(|change| written_in(self.index, change));
            self.written.extend(written);
        }
        self.index.apply(&changes);
        self.decided.changes.extend(changes);
    }

    /// Keeps the value that a change is about to replace.
    fn keep_former(&mut self, change: &Change) {
        let (index, former) = (&*self.index, &mut self.decided.former);
        match change {
            Change::KeyframeAdded(..) => self.keyframe_arrives = true,
            Change::PoseSet(keyframe, _) => {
                let before = index.keyframe(*keyframe).map(Keyframe::similarity);
                former.poses.extend(before.map(|before| (*keyframe, before)));
            }
            Change::PointSet(session, point, _) => {
                let before = index.points().position(*session, *point);
                if before.is_some() || !self.keyframe_arrives {
                    former.points.push((*session, *point, before));
                }
            }
            Change::PointsForgotten(session, points) => {
                let before =
                    points.iter().filter_map(|id| Some((*id, index.points().position(*session, *id)?)));
                former.forgotten.extend(before.map(|(id, position)| (*session, id, position)));
            }
            _ => {}
        }
    }

    /// Something about the objects of these anchors changes: their versions grow when the request ends.
    pub fn touch(&mut self, anchors: impl IntoIterator<Item = AnchorSeq>) {
        self.touched.extend(anchors);
    }

    /// Two anchors turn out to be one object; `told` adds to the event that says so.
    pub fn merge(&mut self, merge: Merge, told: impl FnOnce(&mut Event)) {
        let mut event = Event::of(EventKind::AnchorsMerged);
        (event.anchor, event.other) = (Some(merge.into), Some(merge.from));
        told(&mut event);
        self.emit(event);
        self.touch([merge.into, merge.from]);
        self.apply(vec![Change::Merged(merge)]);
    }

    /// Something happened.
    pub fn emit(&mut self, event: Event) {
        self.decided.events.push(event);
    }

    /// Keeps what revokes the merge of sessions that this request is; earlier ones that it touches are settled.
    pub fn keep_undo(&mut self, undo: MergeUndo) {
        self.undo = Some(Box::new(undo));
    }

    /// Ends the request: the touched anchors get their new versions.
    pub fn finish(mut self) -> Decided {
        let mut versions = BTreeSet::new();
        for anchor in std::mem::take(&mut self.touched) {
            versions.extend(self.index.objects().root(anchor));
            versions.insert(anchor);
        }
        let changes = versions
            .into_iter()
            .filter_map(|seq| Some(Change::AnchorTouched(seq, self.index.anchor(seq)?.version + 1)))
            .collect();
        self.apply(changes);
        let settled = self.index.open_merges().touching(&self.written);
        let settled = settled.into_iter().map(Change::MergeSettled);
        let last: Vec<Change> = settled.chain(self.undo.take().map(Change::MergeKept)).collect();
        if !last.is_empty() {
            self.apply(last);
        }
        self.decided
    }
}

/// Returns the sessions whose keyframes or map points a change concerns, before it is applied.
fn written_in(index: &MapIndex, change: &Change) -> Vec<SessionSeq> {
    let of_keyframe = |seq: &KeyframeSeq| index.session_of(*seq).into_iter().collect();
    match change {
        Change::KeyframeAdded(keyframe, _) => vec![keyframe.session],
        Change::KeyframeRemoved(seq, _)
        | Change::PoseSet(seq, _)
        | Change::PointsOfDetectionSet(_, seq, ..) => of_keyframe(seq),
        Change::PointsOfKeyframeSet(points) => of_keyframe(&points.keyframe),
        Change::PointSet(session, ..) | Change::PointsForgotten(session, _) => vec![*session],
        Change::SessionsMerged(merge) => vec![merge.session, merge.into],
        _ => Vec::new(),
    }
}
