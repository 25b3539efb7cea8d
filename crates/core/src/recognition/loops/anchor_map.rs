//! The local anchor map M_k of a keyframe (§V-A).
//!
//! An anchor A belongs to M_k if K_A^cov, the union of the covisible sets of the keyframes that
//! observe it, meets K_k^cov. K_m^cov contains m itself (M1): without that, a
//! keyframe without covisible neighbours would have an empty map though it sees a door plate.

use std::sync::Arc;

use super::centre::{Centre, InlineAnchor};
use crate::domain::anchor::AnchorState;
use crate::domain::ids::{AnchorSeq, SessionSeq};
use crate::domain::verdict::AnchorName;
use crate::geometry::{Bearing, Point3};
use crate::recognition::extensions::distinctiveness::PlaceCounts;
use crate::recognition::map::index::{Certainty, MapIndex, TextId};
use crate::semantics::{self, Text, TextKind};

/// Which anchor an entry of a local map is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum LocalName {
    /// An object of the map, by its oldest anchor.
    MergedAnchor(AnchorSeq),
    /// A detection of an inline keyframe, which founds no anchor.
    Inline(usize),
}

impl LocalName {
    /// Returns the object of the map, if it is one.
    pub fn object(self) -> Option<AnchorSeq> {
        match self {
            Self::MergedAnchor(seq) => Some(seq),
            Self::Inline(_) => None,
        }
    }

    /// Returns the name for the outside.
    pub fn public(self) -> AnchorName {
        match self {
            Self::MergedAnchor(seq) => AnchorName::Stored(seq.public()),
            Self::Inline(number) => AnchorName::Inline(number),
        }
    }
}

/// One anchor of a local anchor map.
#[derive(Clone, Debug)]
pub struct LocalAnchor {
    /// Which.
    pub name: LocalName,
    /// Its class.
    pub class: Box<str>,
    /// How far its description is. Only valid anchors take part in Eq. (2).
    pub state: AnchorState,
    /// What it is called, as last read.
    pub description: Option<Box<str>>,
    /// The same, parsed.
    pub text: Option<Arc<Text>>,
    /// The kind of the text, if it is described.
    pub kind: Option<TextKind>,
    /// The same as a text of the map, if it is one.
    pub text_id: Option<TextId>,
    /// The certainty of its text.
    pub certainty: Certainty,
    /// Its centre, in the frame of the central keyframe's session.
    pub centre_in_session: Point3,
    /// Where it stands as seen from the central keyframe: theta_m and d_m of §V-B.
    pub bearing: Bearing,
    /// Whether nothing measured d_m: theta_m alone counts.
    pub range_assumed: bool,
    /// Its weight in Eq. (2): 1/d, or 1 where d was assumed, divided by the number of places it stands at if the map's
    /// settings ask for distinctive weights.
    pub weight: f64,
    /// The number of places it stands at; 1 unless the map's settings ask for distinctive weights.
    pub places: usize,
}

impl LocalAnchor {
    /// Whether the two are of one class and their names exclude each other.
    pub fn excludes(&self, other: &Self) -> bool {
        let texts = self.text.as_deref().zip(other.text.as_deref());
        self.class == other.class && texts.is_some_and(|(own, other)| semantics::is_conflict(own, other))
    }

    /// Returns its centre in the frame of the central keyframe's camera, in metres.
    pub fn centre_in_camera(&self) -> Point3 {
        Point3::from(self.bearing.direction_in_camera().map(|axis| axis * self.bearing.distance_m()))
    }

    /// Whether the distances of both were measured, so that these may be compared.
    pub fn is_measured_with(&self, other: &Self) -> bool {
        !(self.range_assumed || other.range_assumed)
    }
}

/// The anchors around one keyframe, ordered by name.
#[derive(Clone, Debug, Default)]
pub struct LocalAnchorMap {
    /// The session whose frame the anchors are in; none if the map does not know it.
    pub session: Option<SessionSeq>,
    /// The anchors.
    pub anchors: Vec<LocalAnchor>,
}

impl LocalAnchorMap {
    /// Returns the anchors that take part in Eq. (2).
    pub fn valid(&self) -> impl Iterator<Item = &LocalAnchor> {
        self.anchors.iter().filter(|anchor| anchor.state == AnchorState::Valid)
    }

    /// Returns the `most` heaviest valid anchors, by weight; the nearest ones are the heaviest.
    pub fn heaviest(&self, most: usize) -> Vec<&LocalAnchor> {
        let mut anchors: Vec<&LocalAnchor> = self.valid().collect();
        anchors.sort_by(|a, b| b.weight.total_cmp(&a.weight).then_with(|| a.name.cmp(&b.name)));
        anchors.truncate(most);
        anchors
    }

    /// Returns how many anchors nothing has described yet.
    pub fn pending(&self) -> usize {
        self.anchors.iter().filter(|anchor| anchor.state == AnchorState::Pending).count()
    }
}

/// Builds M_k.
pub fn local_anchor_map(index: &MapIndex, centre: &Centre, places: &mut PlaceCounts) -> LocalAnchorMap {
    let roots = if index.objects().is_empty() {
        Vec::new()
    } else {
        index.objects_seen_by_any(&index.covisibility().around(&centre.covisible))
    };
    let stored = roots.into_iter().filter_map(|root| stored_anchor(index, centre, root, places));
    let mut anchors: Vec<LocalAnchor> = stored.collect();
    anchors.extend(centre.inline.iter().map(|inline| inline_anchor(index, centre, inline, places)));
    LocalAnchorMap { session: centre.session, anchors }
}

/// Returns an object as an anchor around a keyframe; none where nothing places it in the keyframe's session.
pub(in crate::recognition) fn stored_anchor(
    index: &MapIndex,
    centre: &Centre,
    root: AnchorSeq,
    places: &mut PlaceCounts,
) -> Option<LocalAnchor> {
    let object = index.objects().get(root)?;
    // An anchor seen only in another session's frame cannot be placed around this keyframe.
    let shape = object.shapes.get(&centre.session?)?;
    let (centre_in_session, range_assumed) = (shape.aabb?.centre(), shape.range_assumed);
    let text_id = index.texts().of(root);
    let bearing = Bearing::of(&centre_in_session, &centre.map_from_camera);
    let places = places_at(index, || text_id.map_or(1, |text| places.of_text(index, text)));
    Some(LocalAnchor {
        name: LocalName::MergedAnchor(root),
        class: index.class_of(object).into(),
        state: object.state,
        description: object.description.as_ref().map(|description| description.raw.clone()),
        text: object.description.as_ref().map(|description| description.text.clone()),
        kind: object.description.as_ref().map(|description| description.kind),
        text_id,
        certainty: object
            .description
            .as_ref()
            .map_or(Certainty::ReadOnce, |description| description.certainty),
        centre_in_session,
        bearing,
        range_assumed,
        weight: weight(&bearing, range_assumed, places),
        places,
    })
}

fn inline_anchor(
    index: &MapIndex,
    centre: &Centre,
    inline: &InlineAnchor,
    places: &mut PlaceCounts,
) -> LocalAnchor {
    let settings = &index.properties().settings;
    let level = inline.information_level().map(u32::from);
    let state = match level {
        None => AnchorState::Pending,
        Some(level) if level >= settings.description_min_information_level => AnchorState::Valid,
        Some(_) => AnchorState::Uninformative,
    };
    let text = inline.text.as_ref().filter(|_| state == AnchorState::Valid);
    let text_id = text.and_then(|text| index.texts().find(&inline.class, text));
    let bearing = Bearing::of(&inline.centre_in_session, &centre.map_from_camera);
    let places = places_at(index, || match (text_id, text) {
        (Some(known), _) => places.of_text(index, known),
        (None, Some(text)) => places.of_guest(index, &inline.class, text),
        (None, None) => 1,
    });
    LocalAnchor {
        name: LocalName::Inline(inline.detection),
        class: inline.class.clone(),
        state,
        description: inline.raw.clone(),
        text: inline.text.clone(),
        kind: inline.text.as_ref().map(
            |text| {
                if inline.described { text.kind().described() } else { text.kind() }
            },
        ),
        text_id,
        certainty: match inline.described {
            true => Certainty::Sure,
            false if inline.confidence < settings.reading_min_confidence => Certainty::Doubtful,
            false => Certainty::ReadOnce,
        },
        centre_in_session: inline.centre_in_session,
        bearing,
        range_assumed: inline.range_assumed,
        weight: weight(&bearing, inline.range_assumed, places),
        places,
    }
}

/// A nearer anchor weighs as if it stood at this distance, in metres (M30).
pub(in crate::recognition) const LEAST_DISTANCE_M: f64 = 0.1;

/// 1/d of §V-B, bounded by the least distance, and 1 where d was assumed (M26); divided by p with distinctive
/// weights (M6).
fn weight(bearing: &Bearing, range_assumed: bool, places: usize) -> f64 {
    if range_assumed {
        return 1.0 / places as f64;
    }
    1.0 / bearing.distance_m().max(LEAST_DISTANCE_M) / places as f64
}

/// p of M6, counted only if the map's settings ask for it.
fn places_at(index: &MapIndex, count: impl FnOnce() -> usize) -> usize {
    if index.properties().settings.is_ours() { count() } else { 1 }
}
