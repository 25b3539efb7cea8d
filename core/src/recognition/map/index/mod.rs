//! The index of one map in memory: its facts, and everything derived from them.
//!
//! The law that tests hold: an index built from the store equals the live one, after any
//! sequence of requests. So nothing here may depend on the order in which facts arrived
//! other than through the numbers that are facts themselves.

mod anchor;
mod apply;
mod changed_signs;
mod covisibility;
mod holders;
mod learned;
mod memory;
mod objects;
mod odometer;
mod points;
mod readings;
mod sign_grid;
mod texts;
mod verdicts;
mod votes;

use std::collections::{BTreeMap, BTreeSet, HashMap};

pub use anchor::{Anchor, Shape};
pub use changed_signs::ChangedSigns;
pub use covisibility::Covisibility;
pub use holders::Holders;
pub use objects::{Certainty, Description, MergedAnchor, Objects};
pub use odometer::{Milestone, Odometer, UM_PER_M};
pub use points::{POINT_BYTES, Points};
pub use readings::Readings;
pub use sign_grid::{CELL_M, SignGrid};
pub use texts::{GroupId, IdentityId, TextId, TextIndex, WordGroups};
pub use verdicts::Verdicts;
pub use votes::Votes;

use self::memory::Tally;
use self::objects::Judging;
use super::covisibility::CovisibilityLists;
use super::dense_map::DenseMap;
use super::inverted_file::InvertedFile;
use crate::domain::change::{Keyframe, Loop, Twins};
use crate::domain::ids::{AnchorSeq, KeyframeId, KeyframeSeq, LoopId, SessionId, SessionSeq};
use crate::domain::map::{MapFigures, MapProperties};

/// One map: facts first, then what follows from them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MapIndex {
    properties: MapProperties,
    sessions: Vec<SessionId>,
    /// The number the next keyframe gets, and the next anchor: no number is given twice.
    next_keyframe: u32,
    next_anchor: u32,
    keyframes: DenseMap<Keyframe>,
    anchors: DenseMap<Anchor>,
    loops: BTreeMap<LoopId, Loop>,
    /// Derived: the loops of each keyframe, at both their ends.
    loops_by_keyframe: BTreeMap<KeyframeSeq, BTreeSet<LoopId>>,
    vocabulary: Option<Box<str>>,
    model_away: bool,

    session_by_id: HashMap<SessionId, SessionSeq>,
    keyframe_by_id: HashMap<KeyframeId, KeyframeSeq>,
    /// Of all sessions, keyframes and loops, on disk.
    bytes: u64,
    points: Points,
    holders: Holders,
    lists: CovisibilityLists,
    odometer: Odometer,
    /// The anchors each keyframe sees, ascending; anchors, not objects.
    seen_by: DenseMap<BTreeSet<AnchorSeq>>,
    objects: Objects,
    readings: Readings,
    /// What a model said of texts is a fact among them.
    texts: TextIndex,
    inverted_file: InvertedFile,
    twins: BTreeSet<Twins>,
    changed_signs: ChangedSigns,
    sign_grid: SignGrid,
    /// What [`Self::memory_bytes`] counts with.
    tally: Tally,
}

impl MapIndex {
    /// Returns the map's description, classes and settings.
    pub fn properties(&self) -> &MapProperties {
        &self.properties
    }

    /// Returns the vocabulary the map's words belong to, once there are any.
    pub fn vocabulary(&self) -> Option<&str> {
        self.vocabulary.as_deref()
    }

    /// Returns a session's number.
    pub fn session(&self, id: &SessionId) -> Option<SessionSeq> {
        self.session_by_id.get(id).copied()
    }

    /// Returns the sessions, in order of appearance.
    pub fn sessions(&self) -> &[SessionId] {
        &self.sessions
    }

    /// Returns a keyframe's number.
    pub fn keyframe_seq(&self, id: &KeyframeId) -> Option<KeyframeSeq> {
        self.keyframe_by_id.get(id).copied()
    }

    /// Returns a keyframe, unless it was culled.
    pub fn keyframe(&self, seq: KeyframeSeq) -> Option<&Keyframe> {
        self.keyframes.get(seq.index())
    }

    /// Returns every keyframe, in order of arrival.
    pub fn keyframes(&self) -> impl Iterator<Item = &Keyframe> {
        self.keyframes.values()
    }

    /// Returns the keyframes from this number on, in order of arrival.
    pub fn keyframes_from(&self, first: KeyframeSeq) -> impl Iterator<Item = &Keyframe> {
        self.keyframes.iter_from(first.index()).map(|(_, keyframe)| keyframe)
    }

    /// Returns the number of keyframes.
    pub fn keyframe_count(&self) -> usize {
        self.keyframe_by_id.len()
    }

    /// Returns what the map's facts take on disk, in bytes: keyframes with all they brought, sessions, map points,
    /// merges, loops.
    pub fn bytes(&self) -> u64 {
        self.bytes + self.points.bytes() + self.objects.bytes()
    }

    /// Returns how much the map holds, as lists of maps show it.
    pub fn figures(&self) -> MapFigures {
        MapFigures {
            keyframes: self.keyframe_count() as u64,
            anchors: self.objects.len() as u64,
            sessions: self.sessions.len() as u64,
            loops: self.loops.len() as u64,
            bytes: self.bytes(),
        }
    }

    /// The number the next keyframe gets.
    pub fn next_keyframe(&self) -> KeyframeSeq {
        KeyframeSeq(self.next_keyframe)
    }

    /// Returns an anchor with its own facts, unless it was removed.
    pub fn anchor(&self, seq: AnchorSeq) -> Option<&Anchor> {
        self.anchors.get(seq.index())
    }

    /// Returns the numbers of the anchors from this one on, merged ones among them, oldest first.
    pub fn anchors_from(&self, first: AnchorSeq) -> impl Iterator<Item = AnchorSeq> + '_ {
        self.anchors.iter_from(first.index()).map(|(seq, _)| AnchorSeq(seq as u32))
    }

    /// The number the next anchor gets.
    pub fn next_anchor(&self) -> AnchorSeq {
        AnchorSeq(self.next_anchor)
    }

    /// Returns the confirmed loops.
    pub fn loops(&self) -> &BTreeMap<LoopId, Loop> {
        &self.loops
    }

    /// Returns the confirmed loops of a keyframe, by id.
    pub fn loops_of(&self, keyframe: KeyframeSeq) -> impl Iterator<Item = &Loop> {
        let ids = self.loops_by_keyframe.get(&keyframe).into_iter().flatten();
        ids.filter_map(|id| self.loops.get(id))
    }

    /// Returns the map points.
    pub fn points(&self) -> &Points {
        &self.points
    }

    /// Returns the anchors by map point.
    pub fn holders(&self) -> &Holders {
        &self.holders
    }

    /// Returns the covisibility graph.
    pub fn covisibility(&self) -> Covisibility<'_> {
        Covisibility::of(self)
    }

    /// Returns what is kept of the covisibility graph.
    pub fn covisibility_lists(&self) -> &CovisibilityLists {
        &self.lists
    }

    /// Returns the objects.
    pub fn objects(&self) -> &Objects {
        &self.objects
    }

    /// Returns the readings of the anchors, and the numbering that follows.
    pub fn readings(&self) -> &Readings {
        &self.readings
    }

    /// Returns the texts of valid objects, and which of them match.
    pub fn texts(&self) -> &TextIndex {
        &self.texts
    }

    /// Returns what a model said of texts.
    pub fn verdicts(&self) -> &Verdicts {
        self.texts.verdicts()
    }

    /// Whether the map waits for a model that is away.
    pub fn model_away(&self) -> bool {
        self.model_away
    }

    /// Returns the bag-of-words index.
    pub fn inverted_file(&self) -> &InvertedFile {
        &self.inverted_file
    }

    /// Returns the anchors (not objects) that a keyframe sees, ascending.
    pub fn anchors_seen_by(&self, keyframe: KeyframeSeq) -> impl Iterator<Item = AnchorSeq> + '_ {
        self.seen_by.get(keyframe.index()).into_iter().flatten().copied()
    }

    /// Returns the objects that a keyframe sees, ascending.
    pub fn objects_seen_by(&self, keyframe: KeyframeSeq) -> BTreeSet<AnchorSeq> {
        self.anchors_seen_by(keyframe).filter_map(|anchor| self.objects.root(anchor)).collect()
    }

    /// Returns the keyframes that see an object, ascending.
    pub fn keyframes_of(&self, object: &MergedAnchor) -> BTreeSet<KeyframeSeq> {
        object.members.iter().filter_map(|member| self.anchor(*member)).flat_map(Anchor::keyframes).collect()
    }

    /// Returns an anchor as if it were no part of a larger object.
    pub fn anchor_alone(&self, seq: AnchorSeq) -> Option<MergedAnchor> {
        self.anchor(seq)?;
        Some(MergedAnchor::of(vec![seq], &self.anchors, &self.judging()))
    }

    /// Borrows all that descriptions are judged by.
    fn judging(&self) -> Judging<'_> {
        Judging {
            settings: &self.properties.settings,
            verdicts: self.verdicts(),
            readings: &self.readings,
            changed_signs: &self.changed_signs,
        }
    }

    /// Returns an object's class.
    pub fn class_of(&self, object: &MergedAnchor) -> &str {
        object.members.first().and_then(|member| self.anchor(*member)).map_or("", |anchor| &anchor.class)
    }
}
