//! Which anchors are one object, and what is known of it.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use super::anchor::{Anchor, Shape};
use super::changed_signs::ChangedSigns;
use super::readings::Readings;
use super::reverse::remove_last;
use super::verdicts::Verdicts;
use super::votes::Votes;
use crate::domain::anchor::AnchorState;
use crate::domain::change::{Merge, MergeCause};
use crate::domain::ids::{AnchorSeq, LoopId, SessionSeq};
use crate::domain::settings::Settings;
use crate::geometry::Aabb;
use crate::recognition::map::dense_map::DenseMap;
use crate::semantics::{Numbering, Text, TextKind};

/// All that descriptions are judged by.
#[derive(Clone, Copy, Debug)]
pub(super) struct Judging<'a> {
    pub settings: &'a Settings,
    pub verdicts: &'a Verdicts,
    pub readings: &'a Readings,
    pub changed_signs: &'a ChangedSigns,
}

/// The certainty of an object's text (M7).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Certainty {
    /// It was read once, or never twice alike, and with less confidence than `reading_min_confidence`.
    Doubtful,
    /// It was read once, or never twice alike.
    ReadOnce,
    /// It was read alike twice or more; in one passage, one bad angle misreads the same way twice.
    ReadAlike,
    /// It was described by a model or by hand.
    Sure,
}

/// The text of an object, and its certainty.
#[derive(Clone, Debug, PartialEq)]
pub struct Description {
    /// As last read, or as the operator wrote it.
    pub raw: Box<str>,
    /// The same, parsed.
    pub text: Arc<Text>,
    /// Whether an operator set it.
    pub by_hand: bool,
    /// Its certainty, but for passages, which depend on where the robot drove.
    pub certainty: Certainty,
    /// InformationLevel, 1 to 5, by the built-in judge or by a model.
    pub information_level: u8,
    /// The kind of its text, which a model or a person may have written.
    pub kind: TextKind,
}

/// One physical object: the anchors that links join, under the name of the oldest.
#[derive(Clone, Debug, PartialEq)]
pub struct MergedAnchor {
    /// Its anchors, oldest first.
    pub members: Vec<AnchorSeq>,
    /// What it is called, if anything has described it.
    pub description: Option<Description>,
    /// How far its description is.
    pub state: AnchorState,
    /// All readings of its anchors.
    pub votes: Votes,
    /// Its map points and its box in the frame of each session that saw it.
    pub shapes: BTreeMap<SessionSeq, Shape>,
}

impl MergedAnchor {
    /// Its box in a session's frame, if it has one there.
    pub fn aabb(&self, session: SessionSeq) -> Option<Aabb> {
        self.shapes.get(&session)?.aabb
    }

    /// Derives the object from its anchors; `members` oldest first, never empty.
    pub(super) fn of(members: Vec<AnchorSeq>, anchors: &DenseMap<Anchor>, judging: &Judging<'_>) -> Self {
        let Judging { settings, verdicts, readings, changed_signs } = *judging;
        let mut votes = Votes::default();
        let mut shapes: BTreeMap<SessionSeq, Shape> = BTreeMap::new();
        let (mut by_hand, mut by_plan) = (None, None);
        for anchor in members.iter().filter_map(|member| anchors.get(member.index())) {
            votes.add_all(&anchor.votes);
            for (session, shape) in &anchor.shapes {
                shapes.entry(*session).or_default().join(shape);
            }
            by_hand = by_hand.or(anchor.description_by_hand.as_deref());
            by_plan = by_plan.or(anchor.prior.as_ref().map(|prior| &*prior.description));
        }
        let class = members.first().and_then(|first| anchors.get(first.index()));
        let class = class.map_or("", |anchor| &anchor.class);
        let numbering = readings.numbering(class);
        let elected = votes.elected(numbering);
        let mut description = match (by_hand, by_plan, &elected) {
            (Some(raw), ..) => Some(Description::new(raw, numbering, true, Certainty::Sure)),
            (None, Some(raw), _) => Some(Description::new(raw, numbering, false, Certainty::Sure)),
            (None, None, Some(elected)) => {
                let agree = elected.count >= settings.agreeing_reads as usize;
                let certainty = match elected.count {
                    _ if elected.described && agree => Certainty::Sure,
                    0 | 1 if elected.weight < settings.reading_min_confidence => Certainty::Doubtful,
                    0 | 1 => Certainty::ReadOnce,
                    _ => Certainty::ReadAlike,
                };
                // Two codes make no third one.
                let to_merge = votes.to_merge().filter(|_| !readings.is_of_codes(class));
                let merged = to_merge.and_then(|(a, b)| verdicts.merged(class, a, b));
                Some(Description::new(merged.unwrap_or(&elected.text), numbering, false, certainty))
            }
            (None, None, None) => None,
        };
        let is_unsure = by_hand.is_none()
            && elected.as_ref().is_some_and(|elected| elected.is_doubtful(settings.reading_min_confidence));
        if let Some(description) = &mut description {
            let text = &description.text;
            let is_doubtful = is_unsure && !text.is_described() && !readings.is_alike(class, text);
            if by_hand.is_some() || elected.as_ref().is_some_and(|elected| elected.described) {
                description.kind = description.kind.described();
            }
            description.information_level =
                if is_doubtful { 1 } else { verdicts.information_level(class, &description.text) };
        }
        let is_retired =
            || settings.signs_may_change && members.iter().all(|member| changed_signs.is_retired(*member));
        let state = match &description {
            _ if is_retired() => AnchorState::Retired,
            None => AnchorState::Pending,
            Some(d) if u32::from(d.information_level) >= settings.description_min_information_level => {
                AnchorState::Valid
            }
            Some(_) => AnchorState::Uninformative,
        };
        Self { members, description, state, votes, shapes }
    }
}

impl Description {
    fn new(raw: &str, numbering: Option<&Numbering>, by_hand: bool, certainty: Certainty) -> Self {
        let text = Arc::new(Text::under(raw, numbering));
        let (information_level, kind) = (text.information_level(), text.kind());
        Self { raw: raw.into(), text, by_hand, certainty, information_level, kind }
    }
}

/// The objects of a map.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Objects {
    /// The links, at both their ends.
    links: BTreeMap<AnchorSeq, BTreeSet<Merge>>,
    /// Of the links, on disk.
    bytes: u64,
    root_of: BTreeMap<AnchorSeq, AnchorSeq>,
    by_root: BTreeMap<AnchorSeq, MergedAnchor>,
}

impl Objects {
    /// Returns the object an anchor belongs to, by the name of its oldest anchor.
    pub fn root(&self, anchor: AnchorSeq) -> Option<AnchorSeq> {
        self.root_of.get(&anchor).copied()
    }

    /// Returns an object by its oldest anchor.
    pub fn get(&self, root: AnchorSeq) -> Option<&MergedAnchor> {
        self.by_root.get(&root)
    }

    /// Returns every object, oldest first.
    pub fn iter(&self) -> impl Iterator<Item = (AnchorSeq, &MergedAnchor)> {
        self.by_root.iter().map(|(root, object)| (*root, object))
    }

    /// Returns the number of objects.
    pub fn len(&self) -> usize {
        self.by_root.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.by_root.is_empty()
    }

    /// Returns how many anchors they are made of.
    pub fn anchor_count(&self) -> usize {
        self.root_of.len()
    }

    /// Returns what the links take on disk, in bytes.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }

    /// Returns the links of an anchor.
    pub fn links(&self, anchor: AnchorSeq) -> impl Iterator<Item = &Merge> {
        self.links.get(&anchor).into_iter().flatten()
    }

    /// Returns the links that a loop made.
    pub fn links_of_loop(&self, id: &LoopId) -> Vec<Merge> {
        let made = |merge: &&Merge| merge.cause == MergeCause::Loop(id.clone());
        self.links
            .iter()
            .flat_map(|(end, set)| set.iter().filter(made).filter(|m| m.into == *end))
            .cloned()
            .collect()
    }

    /// Returns the anchors joined to one by links that hold within a single passage: not by loops.
    pub fn same_passage(&self, anchor: AnchorSeq) -> BTreeSet<AnchorSeq> {
        self.component(anchor, |merge| merge.cause == MergeCause::Covisible)
    }

    pub(super) fn link(&mut self, merge: &Merge) {
        if self.links(merge.into).any(|known| known == merge) {
            return;
        }
        self.bytes += merge.bytes();
        for end in [merge.into, merge.from] {
            self.links.entry(end).or_default().insert(merge.clone());
        }
    }

    pub(super) fn unlink(&mut self, merge: &Merge) {
        if self.links(merge.into).all(|known| known != merge) {
            return;
        }
        self.bytes -= merge.bytes();
        for end in [merge.into, merge.from] {
            if remove_last(self.links.get_mut(&end), merge) {
                self.links.remove(&end);
            }
        }
    }

    /// Derives anew the objects that these anchors belong to or belonged to. Returns the names
    /// that are gone and the names that stand now.
    pub(super) fn regroup(
        &mut self,
        touched: &BTreeSet<AnchorSeq>,
        anchors: &DenseMap<Anchor>,
        judging: &Judging<'_>,
    ) -> (BTreeSet<AnchorSeq>, BTreeSet<AnchorSeq>) {
        let before: BTreeSet<AnchorSeq> = touched.iter().filter_map(|anchor| self.root(*anchor)).collect();
        let mut open: BTreeSet<AnchorSeq> = touched.clone();
        for root in &before {
            if let Some(object) = self.by_root.remove(root) {
                open.extend(object.members);
            }
        }
        let mut after = BTreeSet::new();
        while let Some(anchor) = open.pop_first() {
            if anchors.get(anchor.index()).is_none() {
                self.root_of.remove(&anchor);
                continue;
            }
            let members = self.component(anchor, |_| true);
            let root = *members.first().unwrap_or(&anchor);
            for member in &members {
                open.remove(member);
                self.root_of.insert(*member, root);
            }
            let object = MergedAnchor::of(members.into_iter().collect(), anchors, judging);
            self.by_root.insert(root, object);
            after.insert(root);
        }
        (before.difference(&after).copied().collect(), after)
    }

    fn component(&self, start: AnchorSeq, follows: impl Fn(&Merge) -> bool) -> BTreeSet<AnchorSeq> {
        let mut seen = BTreeSet::from([start]);
        let mut open = vec![start];
        while let Some(anchor) = open.pop() {
            for merge in self.links(anchor).filter(|merge| follows(merge)) {
                for end in [merge.into, merge.from] {
                    if seen.insert(end) {
                        open.push(end);
                    }
                }
            }
        }
        seen
    }
}
