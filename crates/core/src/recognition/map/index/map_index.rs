//! One map: its facts, and what is looked up in them.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use super::anchor::{Anchor, Shape};
use super::changed_signs::ChangedSigns;
use super::globals::Globals;
use super::holders::Holders;
use super::objects::{Judging, MergedAnchor, Objects};
use super::odometer::Odometer;
use super::open_merges::OpenMerges;
use super::points::Points;
use super::priors::Priors;
use super::readings::Readings;
use super::sign_grid::SignGrid;
use super::tally::Tally;
use super::texts::TextIndex;
use super::touched::Touched;
use super::verdicts::Verdicts;
use crate::domain::anchor::Observation;
use crate::domain::change::{Keyframe, Loop, MissedSign, Twins};
use crate::domain::ids::{AnchorSeq, KeyframeId, KeyframeSeq, LoopId, SessionId, SessionSeq};
use crate::domain::map::{MapFigures, MapProperties};
use crate::recognition::map::covisibility::CovisibilityLists;
use crate::recognition::map::dense_map::DenseMap;
use crate::recognition::map::inverted_file::InvertedFile;

/// One map: facts first, then what follows from them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MapIndex {
    pub(super) properties: MapProperties,
    pub(super) sessions: Vec<SessionId>,
    /// The number the next keyframe gets, and the next anchor: no number is given twice.
    pub(super) next_keyframe: u32,
    pub(super) next_anchor: u32,
    pub(super) keyframes: DenseMap<Keyframe>,
    pub(super) anchors: DenseMap<Anchor>,
    pub(super) loops: BTreeMap<LoopId, Loop>,
    /// Derived: the loops of each keyframe, at both their ends.
    pub(super) loops_by_keyframe: BTreeMap<KeyframeSeq, BTreeSet<LoopId>>,
    pub(super) vocabulary: Option<Box<str>>,
    pub(super) model_away: bool,

    pub(super) session_by_id: HashMap<SessionId, SessionSeq>,
    /// Ordered: a hash map of a million names stops one insert for its whole growth, 0.2 s.
    pub(super) keyframe_by_id: BTreeMap<KeyframeId, KeyframeSeq>,
    /// Of all sessions and loops, on disk.
    pub(super) bytes: u64,
    pub(super) points: Points,
    pub(super) holders: Holders,
    pub(super) lists: CovisibilityLists,
    pub(super) odometer: Odometer,
    /// Derived: how many keyframes of a session are unlinked, where any is (M62).
    pub(super) unlinked: BTreeMap<SessionSeq, u32>,
    /// The anchors each keyframe sees, ascending; anchors, not objects.
    pub(super) seen_by: DenseMap<BTreeSet<AnchorSeq>>,
    pub(super) objects: Objects,
    pub(super) readings: Readings,
    /// Texts of valid objects. Verdicts of models about texts are facts among them.
    pub(super) texts: TextIndex,
    pub(super) inverted_file: InvertedFile,
    pub(super) globals: Globals,
    pub(super) twins: BTreeSet<Twins>,
    pub(super) changed_signs: ChangedSigns,
    pub(super) sign_grid: SignGrid,
    pub(super) priors: Priors,
    pub(super) open_merges: OpenMerges,
    /// Counts for [`Self::memory_bytes`] and [`Self::bytes`].
    pub(super) tally: Tally,
    /// While a map is loaded part by part: what the parts so far touched. Objects are derived at the end.
    pub(super) put_off: Option<Touched>,
}

impl MapIndex {
    /// Begins to load a map: keyframes follow in order, before the first query. The resulting index is the same.
    pub fn begin_loading(&mut self) {
        self.inverted_file.begin_loading();
    }

    /// Derives objects only once loading ends: an anchor may be observed in every part, and there may be thousands of them. Nothing is
    /// asked of them before, and no fact that comes by then depends on them.
    pub fn put_objects_off(&mut self) {
        self.put_off = Some(Touched::default());
    }

    /// Ends the loading of a map.
    pub fn finish_loading(&mut self) {
        self.inverted_file.finish_loading();
        if let Some(touched) = self.put_off.take() {
            self.derive(touched);
        }
    }

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

    /// Returns the session of a keyframe.
    pub fn session_of(&self, seq: KeyframeSeq) -> Option<SessionSeq> {
        self.keyframe(seq).map(|keyframe| keyframe.session)
    }

    /// Whether two keyframes are near each other in one session's frame: their cameras stand within the radius of a place.
    pub fn are_near(&self, a: KeyframeSeq, b: KeyframeSeq) -> bool {
        let Some((a, b)) = self.keyframe(a).zip(self.keyframe(b)) else { return false };
        let apart_m = (a.map_from_camera.centre() - b.map_from_camera.centre()).norm();
        a.session == b.session && apart_m <= self.properties.settings.distinctive_place_radius_m
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
    /// merges, loops, prior anchors.
    pub fn bytes(&self) -> u64 {
        let of_parts = self.points.bytes() + self.objects.bytes() + self.priors.bytes();
        self.bytes + self.tally.keyframe_bytes + of_parts
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

    /// Returns what is kept of the covisibility graph.
    pub fn covisibility_lists(&self) -> &CovisibilityLists {
        &self.lists
    }

    /// Whether the session of a keyframe has more of them.
    pub fn has_others_of_session(&self, keyframe: KeyframeSeq) -> bool {
        self.keyframe(keyframe).is_some_and(|stored| self.odometer.has_way(stored.session))
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

    /// Returns the global descriptors of the keyframes.
    pub fn globals(&self) -> &Globals {
        &self.globals
    }

    /// Returns the anchors (not objects) that a keyframe sees, ascending.
    pub fn anchors_seen_by(&self, keyframe: KeyframeSeq) -> impl Iterator<Item = AnchorSeq> + '_ {
        self.seen_by.get(keyframe.index()).into_iter().flatten().copied()
    }

    /// Returns the detections of a keyframe that feed an anchor, each with it.
    pub fn detections_of(&self, keyframe: KeyframeSeq) -> impl Iterator<Item = (AnchorSeq, &Observation)> {
        let anchors = self.anchors_seen_by(keyframe).filter_map(|seq| Some((seq, self.anchor(seq)?)));
        anchors.flat_map(move |(seq, anchor)| {
            let of_keyframe = anchor.observations.range((keyframe, 0)..=(keyframe, u16::MAX));
            of_keyframe.map(move |(_, seen)| (seq, seen))
        })
    }

    /// Returns the anchors that detections of a keyframe feed which were sent with a position.
    pub fn anchors_placed_by(&self, keyframe: KeyframeSeq) -> impl Iterator<Item = AnchorSeq> {
        let placed = self.detections_of(keyframe).filter(|(_, seen)| seen.position_as_sent.is_some());
        placed.map(|(anchor, _)| anchor)
    }

    /// Returns a detection of a keyframe, by its number, that feeds an anchor.
    pub fn observation(&self, anchor: AnchorSeq, detection: (KeyframeSeq, u16)) -> Option<&Observation> {
        self.anchor(anchor)?.observations.get(&detection)
    }

    /// Returns the anchor that a detection of a keyframe, by its number, feeds.
    pub fn fed_by(&self, detection: (KeyframeSeq, u16)) -> Option<AnchorSeq> {
        self.anchors_seen_by(detection.0).find(|anchor| self.observation(*anchor, detection).is_some())
    }

    /// Returns the objects that a keyframe sees, ascending.
    pub fn objects_seen_by(&self, keyframe: KeyframeSeq) -> BTreeSet<AnchorSeq> {
        self.anchors_seen_by(keyframe).filter_map(|anchor| self.objects.root(anchor)).collect()
    }

    /// Returns the objects that any of these keyframes sees, ascending.
    pub fn objects_seen_by_any(&self, keyframes: &[KeyframeSeq]) -> Vec<AnchorSeq> {
        let ascending = |mut anchors: Vec<AnchorSeq>| {
            anchors.sort_unstable();
            anchors.dedup();
            anchors
        };
        // Neighbours see the same anchors: each is looked up once.
        let anchors = keyframes.iter().flat_map(|keyframe| self.anchors_seen_by(*keyframe)).collect();
        ascending(ascending(anchors).into_iter().filter_map(|anchor| self.objects.root(anchor)).collect())
    }

    /// Returns the object that an anchor belongs to.
    pub fn object_of(&self, anchor: AnchorSeq) -> Option<&MergedAnchor> {
        self.objects.get(self.objects.root(anchor)?)
    }

    /// Returns the anchors of an object, oldest first.
    pub fn anchors_of(&self, object: &MergedAnchor) -> impl Iterator<Item = &Anchor> {
        object.members.iter().filter_map(|member| self.anchor(*member))
    }

    /// Returns the keyframes that see an object, ascending.
    pub fn keyframes_of(&self, object: &MergedAnchor) -> BTreeSet<KeyframeSeq> {
        self.anchors_of(object).flat_map(Anchor::keyframes).collect()
    }

    /// Returns what the keyframes of a session before one had seen of an object, where the map points are now; `None` if that
    /// is nothing.
    pub fn shape_before(
        &self,
        object: &MergedAnchor,
        session: SessionSeq,
        keyframe: KeyframeSeq,
    ) -> Option<Shape> {
        let mut shape = None;
        for anchor in self.anchors_of(object) {
            for (_, observation) in anchor.observations.range(..(keyframe, 0)) {
                let seen_by = self.keyframe(observation.keyframe);
                if let Some(seen_by) = seen_by.filter(|seen_by| seen_by.session == session) {
                    shape.get_or_insert_with(Shape::default).add(observation, seen_by, &self.points);
                }
            }
        }
        shape
    }

    /// Returns an anchor as if it were no part of a larger object.
    pub fn anchor_alone(&self, seq: AnchorSeq) -> Option<MergedAnchor> {
        self.anchor(seq)?;
        Some(MergedAnchor::of(vec![seq], &self.anchors, &self.judging()))
    }

    /// Borrows all that descriptions are judged by.
    pub(super) fn judging(&self) -> Judging<'_> {
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

    /// Returns the facts about signs that change.
    pub fn changed_signs(&self) -> &ChangedSigns {
        &self.changed_signs
    }

    /// Returns the passages that missed an object since it was last seen.
    pub fn misses_of(&self, object: &MergedAnchor) -> impl Iterator<Item = MissedSign> {
        self.changed_signs.misses_of(&object.members)
    }

    /// Returns what hangs in the place of a retired object, by its oldest anchor, if anything that is still in the map does.
    pub fn replacement_of(&self, object: &MergedAnchor) -> Option<AnchorSeq> {
        self.objects.root(self.changed_signs.replacement_of(&object.members)?)
    }

    /// Returns the prior anchors.
    pub fn priors(&self) -> &Priors {
        &self.priors
    }

    /// Returns an anchor's public id: the name of a prior one, the number of another.
    pub fn anchor_name(&self, seq: AnchorSeq) -> String {
        let prior = self.anchor(seq).and_then(|anchor| anchor.prior.as_ref());
        prior.map_or_else(|| seq.public(), |prior| prior.id.to_string())
    }

    /// Returns the merges of sessions that can be revoked.
    pub fn open_merges(&self) -> &OpenMerges {
        &self.open_merges
    }

    /// Returns the signs by place.
    pub fn sign_grid(&self) -> &SignGrid {
        &self.sign_grid
    }
}
