//! The keyframe that is asked about: one of the map, or one that is not stored.

use std::collections::BTreeSet;

use super::centre::{Centre, inline_centre};
use super::geometry_snapshot::GeometrySnapshot;
use crate::domain::bow::BowVector;
use crate::domain::global_descriptor::GlobalDescriptor;
use crate::domain::ids::{AnchorSeq, KeyframeSeq, SessionSeq};
use crate::domain::keyframe::{NewKeyframe, Stamp};
use crate::domain::roles::Roles;
use crate::recognition::map::index::{MapIndex, TextId};

/// "Is this keyframe a loop?", ready to be answered.
#[derive(Clone, Debug)]
pub struct Query<'a> {
    /// Its number, if it is stored.
    pub keyframe: Option<KeyframeSeq>,
    /// Its bag of words.
    pub bow: &'a BowVector,
    /// The moment at which its image was taken.
    pub stamp: Stamp,
    /// The vector of its whole image, if that can be compared with the map's.
    pub global: Option<GlobalDescriptor>,
    /// What its local anchor map is built around.
    pub centre: Centre,
    /// The objects it sees, ascending.
    pub seen: BTreeSet<AnchorSeq>,
    /// What geometry needs to know of it, if its client told the camera.
    pub snapshot: Option<GeometrySnapshot>,
    /// The roles that models fill where the question is answered.
    pub roles: Roles,
    /// Keyframes that are no candidates, because whoever asks has left them out.
    pub left_out: BTreeSet<KeyframeSeq>,
    /// Whether a loop counts that repeats a confirmed one (M63).
    pub again: bool,
}

impl<'a> Query<'a> {
    /// About a keyframe of the map, with its bag of words from the store.
    pub fn stored(index: &MapIndex, keyframe: KeyframeSeq, bow: &'a BowVector) -> Option<Self> {
        let centre = Centre::stored(index, keyframe)?;
        let stamp = index.keyframe(keyframe)?.stamp;
        let (seen, snapshot) = (index.objects_seen_by(keyframe), GeometrySnapshot::stored(index, keyframe));
        let global = index.globals().get(keyframe);
        Some(Self {
            keyframe: Some(keyframe),
            bow,
            stamp,
            global,
            centre,
            seen,
            snapshot,
            roles: Roles::default(),
            left_out: BTreeSet::new(),
            again: false,
        })
    }

    /// About a keyframe that is not stored, as if it had just arrived.
    pub fn inline(index: &MapIndex, keyframe: &'a NewKeyframe) -> Self {
        let covisible = inline_covisible(index, keyframe);
        Self::not_stored(index, index.session(&keyframe.session), keyframe, covisible)
    }

    /// About a keyframe whose place in the map nobody knows: its pose, its points and its session are its own, whatever
    /// their names and numbers.
    pub fn unplaced(index: &MapIndex, keyframe: &'a NewKeyframe) -> Self {
        Self::not_stored(index, None, keyframe, BTreeSet::new())
    }

    fn not_stored(
        index: &MapIndex,
        session: Option<SessionSeq>,
        keyframe: &'a NewKeyframe,
        covisible: BTreeSet<KeyframeSeq>,
    ) -> Self {
        let (centre, seen) = inline_centre(index, session, keyframe, covisible);
        Self {
            keyframe: None,
            bow: &keyframe.bow,
            stamp: keyframe.stamp,
            global: keyframe.global_descriptor.clone().filter(|of_query| index.globals().takes(of_query)),
            centre,
            seen,
            snapshot: GeometrySnapshot::inline(index, session, keyframe),
            roles: Roles::default(),
            left_out: BTreeSet::new(),
            again: false,
        }
    }

    /// Returns the same question, with these keyframes left out of the candidates.
    pub fn without(self, left_out: BTreeSet<KeyframeSeq>) -> Self {
        Self { left_out, ..self }
    }

    /// Returns the same question, answered where models fill these roles.
    pub fn with_roles(self, roles: Roles) -> Self {
        Self { roles, ..self }
    }

    /// Returns the same question, to which a loop that repeats a confirmed one is a loop if `again` says so.
    pub fn asked(self, again: bool) -> Self {
        Self { again, ..self }
    }

    /// Returns the keyframe that stands for the query in the map: itself, or, not stored, the newest of its neighbours.
    pub fn nearest(&self) -> Option<KeyframeSeq> {
        self.keyframe.or(self.centre.covisible.last().copied())
    }

    /// Whether this keyframe is covisible with the query, or the query itself (§V, check 1).
    pub fn excludes(&self, keyframe: KeyframeSeq) -> bool {
        self.centre.covisible.contains(&keyframe)
    }

    /// Whether a keyframe of the query's session was taken too short a time before or after it (M53).
    pub fn is_too_recent(&self, index: &MapIndex, keyframe: KeyframeSeq) -> bool {
        let gap_s = index.properties().settings.candidates_min_gap_s;
        gap_s > 0.0
            && index.keyframe(keyframe).is_some_and(|other| {
                Some(other.session) == self.centre.session && other.stamp.gap_s(self.stamp) < gap_s
            })
    }

    /// Returns how many keyframes, not covisible with the query, are too recent to be candidates (M53).
    pub fn too_recent(&self, index: &MapIndex) -> usize {
        if index.properties().settings.candidates_min_gap_s <= 0.0 {
            return 0;
        }
        let seqs = index.keyframes().map(|keyframe| keyframe.seq);
        seqs.filter(|seq| !self.excludes(*seq) && self.is_too_recent(index, *seq)).count()
    }

    /// Whether this keyframe is the query itself, or covisible with it for another reason than a confirmed loop. A loop
    /// joins two passages and does not make them one.
    pub fn passes_with(&self, index: &MapIndex, keyframe: KeyframeSeq) -> bool {
        self.excludes(keyframe)
            && self
                .keyframe
                .is_none_or(|own| own == keyframe || index.covisibility().joins_by_sight(own, keyframe))
    }

    /// Returns the covisible keyframes, without the query itself.
    pub fn covisible(&self) -> impl Iterator<Item = KeyframeSeq> + '_ {
        self.centre.covisible.iter().copied().filter(|keyframe| Some(*keyframe) != self.keyframe)
    }

    /// Returns the texts of the map that match what the query sees and no object of the map is.
    pub fn inline_texts(&self, index: &MapIndex) -> Vec<TextId> {
        let settings = &index.properties().settings;
        let is_valid = |level: u8| u32::from(level) >= settings.description_min_information_level;
        let valid =
            self.centre.inline.iter().filter(|anchor| anchor.information_level().is_some_and(is_valid));
        let texts = valid.filter_map(|anchor| Some((&anchor.class, anchor.text.as_ref()?)));
        texts
            .filter(|(_, text)| index.texts().with_itself(text).is_some())
            .flat_map(|(class, text)| index.texts().matching_text(class, text))
            .collect()
    }
}

/// Returns the keyframes an inline keyframe would be covisible with.
fn inline_covisible(index: &MapIndex, keyframe: &NewKeyframe) -> BTreeSet<KeyframeSeq> {
    let mut covisible: BTreeSet<KeyframeSeq> =
        keyframe.declared().iter().filter_map(|(id, _)| index.keyframe_seq(id)).collect();
    if let Some(session) = index.session(&keyframe.session) {
        let enough = index.properties().settings.covisibility_min_shared_points;
        covisible.extend(
            index
                .points()
                .sharing(session, keyframe.observes.iter().copied())
                .into_iter()
                .filter(|(_, n)| *n >= enough)
                .map(|(k, _)| k),
        );
        covisible.extend(index.along_drive_of(session, keyframe));
    }
    covisible
}
