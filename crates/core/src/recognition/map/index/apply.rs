//! Applying changes: facts first, then, once, what they touched is derived anew.

use std::collections::BTreeSet;

use super::anchor::Anchor;
use super::map_index::MapIndex;
use super::objects::MergedAnchor;
use super::reverse::remove_last;
use super::texts::TextIndex;
use super::touched::Touched;
use crate::domain::anchor::{AnchorState, Observation};
use crate::domain::bow::BowVector;
use crate::domain::change::{Change, ForgottenParts, Keyframe, Loop, Merge, MergeCause, MovedObservation};
use crate::domain::ids::{AnchorSeq, KeyframeSeq, LoopId, PointId, SessionSeq};
use crate::domain::judged::{Finding, ModelVerdict};
use crate::domain::map::MapProperties;
use crate::domain::prior::Prior;

impl MapIndex {
    /// Applies one request's changes, in their order.
    pub fn apply(&mut self, changes: &[Change]) {
        let put_off = self.put_off.take();
        let is_put_off = put_off.is_some();
        let mut touched = put_off.unwrap_or_default();
        for change in changes {
            self.apply_fact(change, &mut touched);
        }
        if is_put_off {
            self.put_off = Some(touched);
        } else {
            self.derive(touched);
        }
    }

    /// Makes the dense numbers start here: those below were given to facts that are gone.
    pub fn reserve(&mut self, keyframes: u32, anchors: u32) {
        self.next_keyframe = self.next_keyframe.max(keyframes);
        self.next_anchor = self.next_anchor.max(anchors);
    }

    fn apply_fact(&mut self, change: &Change, touched: &mut Touched) {
        match change {
            Change::MapSet(properties) => self.set_properties(properties, touched),
            Change::VocabularySet(name) => self.vocabulary = Some(name.clone()),
            Change::SessionAdded(seq, id) => {
                self.sessions.resize(self.sessions.len().max(seq.index() + 1), id.clone());
                self.sessions[seq.index()] = id.clone();
                if self.session_by_id.insert(id.clone(), *seq).is_none() {
                    self.bytes += id.as_str().len() as u64;
                }
            }
            Change::KeyframeAdded(keyframe, bow) => self.add_keyframe(keyframe, bow),
            Change::GlobalDescriptorSet(seq, descriptor) => self.globals.insert(*seq, descriptor),
            Change::PartsForgotten(parts) => self.forget_parts(parts, touched),
            Change::KeyframeRemoved(seq, bow) => self.remove_keyframe(*seq, bow, touched),
            Change::PoseSet(seq, pose) => {
                if let Some(keyframe) = self.keyframes.get_mut(seq.index())
                    && keyframe.similarity() != *pose
                {
                    keyframe.move_to(pose);
                    touched.moved.insert(*seq);
                    self.retrack(*seq);
                }
            }
            Change::PointSet(session, id, position) => {
                self.points.set_position(*session, *id, *position);
                touched.stale.extend(self.holders.of(*session, *id));
            }
            Change::PointsForgotten(session, ids) => self.forget_points(*session, ids, touched),
            Change::AnchorAdded(seq, class) => {
                self.reserve(0, seq.0 + 1);
                self.anchors.insert(seq.index(), Anchor::new(class.clone()));
                touched.anchors.insert(*seq);
            }
            Change::PriorSet(seq, prior) => self.set_prior(*seq, prior, touched),
            Change::AnchorRemoved(seq) => self.remove_anchor(*seq, touched),
            Change::Observed(seq, observation) => self.observe(*seq, observation, touched),
            Change::ObservationMoved(moved) => self.move_observation(moved, touched),
            Change::OutcomeSet(..) | Change::JudgementAdvanced(_) | Change::ObservationsSent(_) => {}
            Change::PointsOfKeyframeSet(points) => self.set_points_of_keyframe(points),
            Change::PointsOfDetectionSet(seq, keyframe, detection, points) => {
                self.set_points_of_detection(*seq, (*keyframe, *detection), points, touched);
            }
            Change::DescriptionSet(seq, text) => {
                if let Some(anchor) = self.anchor_mut(*seq) {
                    anchor.description_by_hand.clone_from(text);
                    touched.anchors.insert(*seq);
                }
            }
            Change::AnchorTouched(seq, version) => {
                if let Some(anchor) = self.anchor_mut(*seq) {
                    anchor.version = *version;
                }
            }
            Change::Merged(merge) => {
                self.objects.link(merge);
                touched.anchors.extend([merge.into, merge.from]);
            }
            Change::Parted(merge) => self.unlink(std::slice::from_ref(merge), touched),
            Change::SessionsMerged(_)
            | Change::MergeKept(_)
            | Change::MergeSettled(_)
            | Change::MergeRevoked(_) => self.apply_merge(change, touched),
            Change::LoopAdded(closed) => {
                self.join_by_loop(closed);
                self.bytes += closed.bytes();
                if let Some(before) = self.loops.insert(closed.id.clone(), closed.clone()) {
                    self.bytes -= before.bytes();
                    self.forget_loop_of(&before);
                }
                for end in [closed.keyframe, closed.candidate] {
                    self.loops_by_keyframe.entry(end).or_default().insert(closed.id.clone());
                }
            }
            Change::LoopRemoved(id) => self.remove_loop(id, touched),
            Change::CropRead(read) => {
                if let Some(anchor) = self.anchors.get_mut(read.anchor.index())
                    && let Some(observation) = anchor.observations.get_mut(&(read.keyframe, read.detection))
                {
                    self.readings.count(&anchor.class, read.anchor, observation, &mut touched.parsed, false);
                    observation.crop_reading = Some(read.reading.clone());
                    self.readings.count(&anchor.class, read.anchor, observation, &mut touched.parsed, true);
                    touched.stale.insert(read.anchor);
                }
            }
            Change::Judged(verdict) => self.judge(verdict, touched),
            Change::TwinsFound(twins) => {
                self.twins.insert(*twins);
            }
            Change::TwinsWithdrawn(twins) => {
                self.twins.remove(twins);
            }
            Change::SignMissed(_)
            | Change::MissesWithdrawn(_)
            | Change::SignRetired(..)
            | Change::SignReturned(_) => touched.anchors.extend(self.changed_signs.apply(change)),
            Change::ModelAway(away) => self.model_away = *away,
        }
    }

    pub(super) fn derive(&mut self, mut touched: Touched) {
        let moved = std::mem::take(&mut touched.moved);
        touched.stale.extend(moved.into_iter().flat_map(|keyframe| self.anchors_placed_by(keyframe)));
        let (keyframes, points) = (&self.keyframes, &self.points);
        for seq in &touched.stale {
            if let Some(anchor) = self.anchors.get_mut(seq.index()) {
                self.holders.release(&anchor.shapes, *seq);
                let is_code = self.readings.is_of_codes(&anchor.class);
                anchor.refresh(|seq| keyframes.get(seq.index()), is_code, points, &mut touched.parsed);
                self.holders.hold_all(&anchor.shapes, *seq);
            }
        }
        touched.anchors.append(&mut touched.stale);
        if touched.all {
            touched.anchors.extend(self.anchors.iter().map(|(seq, _)| AnchorSeq(seq as u32)));
        }
        touched.anchors.extend(self.readings.take_touched());
        self.renumber(&mut touched);
        let mut objects = std::mem::take(&mut self.objects);
        let (gone, standing) = objects.regroup(&touched.anchors, &self.anchors, &self.judging());
        self.objects = objects;
        for root in gone {
            self.texts.set(root, "", None);
            self.sign_grid.take(root);
        }
        for root in standing {
            let Some(object) = self.objects.get(root) else { continue };
            for member in object.members.iter().skip(1) {
                self.texts.set(*member, "", None);
            }
            let valid = object.description.as_ref().filter(|_| object.state == AnchorState::Valid);
            let class = self.anchors.get(root.index()).map_or("", |anchor| &anchor.class);
            self.texts.set(root, class, valid.map(|description| &description.text));
            self.sign_grid.put(root, object);
        }
    }

    /// Withdraws the texts of classes whose numbering has changed, and has their objects derived anew.
    fn renumber(&mut self, touched: &mut Touched) {
        let changed = self.readings.relearn();
        if changed.is_empty() && !touched.rules {
            return;
        }
        let concerned = |anchor: &Anchor| touched.rules || changed.contains(&anchor.class);
        for (seq, _) in self.anchors.iter().filter(|(_, anchor)| concerned(anchor)) {
            let seq = AnchorSeq(seq as u32);
            self.texts.set(seq, "", None);
            touched.anchors.insert(seq);
        }
    }

    fn set_properties(&mut self, properties: &MapProperties, touched: &mut Touched) {
        self.set_code_classes(&properties.code_classes, touched);
        let before = std::mem::replace(&mut self.properties, properties.clone()).settings;
        let now = self.properties.settings.clone();
        if before.covisibility_min_shared_points != now.covisibility_min_shared_points {
            self.list_neighbours();
        }
        // Only what a setting decides is derived anew: a description is changed in no time, whatever the map holds.
        let min_level = now.matching_min_similarity_level as u8;
        if self.texts.min_level() != min_level {
            let verdicts = std::mem::take(&mut self.texts).into_verdicts();
            self.texts = TextIndex::new(min_level, verdicts);
            touched.all = true;
        }
        if (&before.identifier_patterns, before.learned_identifiers)
            != (&now.identifier_patterns, now.learned_identifiers)
        {
            self.readings.set_rules(&now);
            touched.rules = true;
        }
        touched.all |= before != now;
    }

    /// A verdict about two texts changes whether they match; one about a text, or a merged text, what objects are called.
    fn judge(&mut self, verdict: &ModelVerdict, touched: &mut Touched) {
        self.texts.learn(verdict);
        if matches!(verdict.finding, Finding::Similarity(_)) {
            return;
        }
        let concerned = |object: &MergedAnchor| match &verdict.finding {
            Finding::Merge(_) => object.votes.says(&verdict.a) && object.votes.says(&verdict.b),
            _ => object.description.as_ref().is_some_and(|d| d.text.normalised() == &*verdict.a),
        };
        let objects = self.objects.iter().filter(|(_, object)| self.class_of(object) == &*verdict.class);
        touched.anchors.extend(objects.filter(|(_, object)| concerned(object)).map(|(root, _)| root));
    }

    /// Lists the neighbours by shared points anew; what clients declared and loops stay.
    fn list_neighbours(&mut self) {
        let mut lists = std::mem::take(&mut self.lists);
        lists.clear_sharing();
        for keyframe in self.keyframes.values() {
            lists.add(keyframe.seq, &self.covisibility().counted(keyframe.seq));
        }
        self.lists = lists;
        self.retrack_all();
    }

    /// A confirmed loop makes its two keyframes covisible, as long as both are there.
    fn join_by_loop(&mut self, closed: &Loop) {
        if self.keyframe(closed.keyframe).is_some() && self.keyframe(closed.candidate).is_some() {
            self.lists.join_by_loop(closed.keyframe, closed.candidate);
        }
    }

    fn add_keyframe(&mut self, keyframe: &Keyframe, bow: &BowVector) {
        self.reserve(keyframe.seq.0 + 1, 0);
        self.points.observe(keyframe.session, keyframe.observes.iter(), keyframe.seq);
        self.keyframe_by_id.insert(keyframe.id.clone(), keyframe.seq);
        self.inverted_file.insert(keyframe.seq.0, bow);
        self.seen_by.insert(keyframe.seq.index(), BTreeSet::new());
        self.tally.add_keyframe(keyframe);
        self.keyframes.insert(keyframe.seq.index(), keyframe.clone());
        let sharing = self.covisibility().counted(keyframe.seq);
        self.lists.add(keyframe.seq, &sharing);
        self.track(keyframe.seq);
        for (other, points) in keyframe.declared() {
            self.lists.declare(keyframe.seq, *other, *points);
        }
    }

    fn forget_points(&mut self, session: SessionSeq, ids: &[PointId], touched: &mut Touched) {
        for id in ids {
            self.points.clear_position(session, *id);
            // Nobody holds it, but where a correction is loaded on top of rows that were written after it.
            touched.stale.extend(self.holders.of(session, *id));
        }
    }

    fn forget_parts(&mut self, parts: &ForgottenParts, touched: &mut Touched) {
        let Some(keyframe) = self.keyframes.get_mut(parts.keyframe.index()) else { return };
        self.tally.remove_keyframe(keyframe);
        keyframe.bytes = keyframe.bytes.saturating_sub(parts.bytes);
        self.tally.add_keyframe(keyframe);
        if parts.global_descriptor {
            self.globals.remove(parts.keyframe);
        }
        for (detection, anchor) in &parts.crops {
            if let Some(seq) = *anchor
                && let Some(observation) = self.observation_mut(seq, (parts.keyframe, *detection))
            {
                observation.crop_area_px = None;
                touched.stale.insert(seq);
            }
        }
    }

    fn remove_keyframe(&mut self, seq: KeyframeSeq, bow: &BowVector, touched: &mut Touched) {
        let sharing = self.covisibility().sharing(seq).into_owned();
        self.untrack(seq);
        let Some(keyframe) = self.keyframes.remove(seq.index()) else { return };
        self.keyframe_by_id.remove(&keyframe.id);
        self.points.forget(keyframe.session, keyframe.observes.iter(), seq);
        self.inverted_file.remove(seq.0, bow);
        self.globals.remove(seq);
        self.tally.remove_keyframe(&keyframe);
        // What others declared about it is no fact of the map any more.
        for (neighbour, _) in self.lists.edges(seq) {
            let declared =
                self.keyframes.get_mut(neighbour.index()).and_then(|other| other.declared.as_mut());
            if let Some(declared) = declared {
                *declared = declared.iter().copied().filter(|(other, _)| *other != seq).collect();
            }
        }
        self.lists.remove(seq, &sharing);
        for holder in self.seen_by.remove(seq.index()).unwrap_or_default() {
            if let Some(anchor) = self.anchors.get_mut(holder.index()) {
                let class = anchor.class.clone();
                let gone = anchor.observations.extract_if(.., |(keyframe, _), _| *keyframe == seq);
                for (_, observation) in gone {
                    self.tally.remove_observation(&observation);
                    self.readings.count(&class, holder, &observation, &mut touched.parsed, false);
                }
            }
            touched.stale.insert(holder);
        }
    }

    fn observe(&mut self, seq: AnchorSeq, observation: &Observation, touched: &mut Touched) {
        let Some(seen_by) = self.keyframes.get(observation.keyframe.index()) else { return };
        let Some(anchor) = self.anchors.get_mut(seq.index()) else { return };
        self.holders.hold(seen_by.session, &observation.map_points, seq);
        let is_code = self.readings.is_of_codes(&anchor.class);
        anchor.observe(observation.clone(), seen_by, is_code, &self.points, &mut touched.parsed);
        self.tally.add_observation(observation);
        self.readings.count(&anchor.class, seq, observation, &mut touched.parsed, true);
        self.seen_by.get_or_insert_with(observation.keyframe.index(), BTreeSet::new).insert(seq);
        touched.anchors.insert(seq);
    }

    fn move_observation(&mut self, moved: &MovedObservation, touched: &mut Touched) {
        let MovedObservation { keyframe, detection, from, to } = *moved;
        let Some(anchor) = self.anchors.get_mut(from.index()) else { return };
        let Some(observation) = anchor.observations.remove(&(keyframe, detection)) else { return };
        self.tally.remove_observation(&observation);
        self.readings.count(&anchor.class, from, &observation, &mut touched.parsed, false);
        let mut others = anchor.observations.range((keyframe, 0)..=(keyframe, u16::MAX));
        if others.next().is_none()
            && let Some(seen) = self.seen_by.get_mut(keyframe.index())
        {
            seen.remove(&from);
        }
        touched.stale.insert(from);
        self.observe(to, &observation, touched);
    }

    fn remove_anchor(&mut self, seq: AnchorSeq, touched: &mut Touched) {
        let Some(anchor) = self.anchors.remove(seq.index()) else { return };
        self.changed_signs.remove_anchor(seq);
        self.priors.remove(&anchor, seq);
        self.holders.release(&anchor.shapes, seq);
        for observation in anchor.observations.values() {
            self.tally.remove_observation(observation);
            self.readings.count(&anchor.class, seq, observation, &mut touched.parsed, false);
        }
        for keyframe in anchor.keyframes() {
            if let Some(seen) = self.seen_by.get_mut(keyframe.index()) {
                seen.remove(&seq);
            }
        }
        let links: Vec<Merge> = self.objects.links(seq).cloned().collect();
        self.unlink(&links, touched);
        touched.anchors.insert(seq);
    }

    fn set_prior(&mut self, seq: AnchorSeq, prior: &Prior, touched: &mut Touched) {
        let Some(anchor) = self.anchors.get_mut(seq.index()) else { return };
        anchor.set_prior(prior.clone());
        self.priors.add(seq, prior);
        touched.anchors.insert(seq);
    }

    fn remove_loop(&mut self, id: &LoopId, touched: &mut Touched) {
        let Some(closed) = self.loops.remove(id) else { return };
        self.bytes -= closed.bytes();
        self.forget_loop_of(&closed);
        self.lists.part_by_loop(closed.keyframe, closed.candidate);
        let made: Vec<Merge> = self.objects.links_of_loop(id);
        debug_assert!(made.iter().all(|merge| merge.cause == MergeCause::Loop(id.clone())));
        self.unlink(&made, touched);
    }

    fn forget_loop_of(&mut self, closed: &Loop) {
        for end in [closed.keyframe, closed.candidate] {
            if remove_last(self.loops_by_keyframe.get_mut(&end), &closed.id) {
                self.loops_by_keyframe.remove(&end);
            }
        }
    }

    fn unlink(&mut self, links: &[Merge], touched: &mut Touched) {
        for merge in links {
            touched.anchors.extend([merge.into, merge.from]);
            self.objects.unlink(merge);
        }
    }

    fn anchor_mut(&mut self, seq: AnchorSeq) -> Option<&mut Anchor> {
        self.anchors.get_mut(seq.index())
    }

    pub(super) fn observation_mut(
        &mut self,
        anchor: AnchorSeq,
        at: (KeyframeSeq, u16),
    ) -> Option<&mut Observation> {
        self.anchor_mut(anchor)?.observations.get_mut(&at)
    }
}
