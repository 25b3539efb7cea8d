//! Decisions in steps: each step's changes are applied before the next step looks.

use std::collections::BTreeSet;

use super::index::MapIndex;
use crate::model::change::Change;
use crate::model::event::Event;
use crate::model::ids::AnchorSeq;

/// What a request changed, and what there is to tell about it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Decided {
    /// The changes, already applied to the index; the store must commit them all or none.
    pub changes: Vec<Change>,
    /// What happened, for those who listen.
    pub events: Vec<Event>,
}

/// Applies changes to an index and keeps them for the store.
pub struct Recorder<'a> {
    index: &'a mut MapIndex,
    decided: Decided,
    touched: BTreeSet<AnchorSeq>,
}

impl<'a> Recorder<'a> {
    /// Starts a request.
    pub fn new(index: &'a mut MapIndex) -> Self {
        Self { index, decided: Decided::default(), touched: BTreeSet::new() }
    }

    /// The map as it stands after the steps so far.
    pub fn index(&self) -> &MapIndex {
        self.index
    }

    /// Applies one step's changes.
    pub fn apply(&mut self, changes: Vec<Change>) {
        self.index.apply(&changes);
        self.decided.changes.extend(changes);
    }

    /// Something about this anchor's object changes: its version grows when the request ends.
    pub fn touch(&mut self, anchor: AnchorSeq) {
        self.touched.insert(anchor);
    }

    /// Something happened.
    pub fn tell(&mut self, event: Event) {
        self.decided.events.push(event);
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
        self.decided
    }
}
