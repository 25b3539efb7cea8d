//! The local anchor map M_k of a keyframe (§V-A).
//!
//! An anchor A belongs to M_k if K_A^cov, the union of the covisible sets of the keyframes that
//! observe it, meets K_k^cov. K_m^cov contains m itself (M1): without that, a
//! keyframe without covisible neighbours would have an empty map though it sees a door plate.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use crate::domain::anchor::AnchorState;
use crate::domain::ids::{AnchorSeq, KeyframeSeq, PointId, SessionSeq};
use crate::domain::keyframe::NewKeyframe;
use crate::domain::verdict::AnchorName;
use crate::geometry::{Bearing, Point3, Pose};
use crate::recognition::anchors::association::{Association, associate};
use crate::recognition::extensions::distinctiveness::PlaceCounts;
use crate::recognition::map::index::{Certainty, MapIndex, TextId};
use crate::semantics::Text;

/// Which anchor an entry of a local map is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum LocalName {
    /// An object of the map, by its oldest anchor.
    MergedAnchor(AnchorSeq),
    /// A detection of an inline keyframe, which founds no anchor.
    Inline(usize),
}

impl LocalName {
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
    /// The same as a text of the map, if it is one.
    pub text_id: Option<TextId>,
    /// The certainty of its text, but for passages ([`crate::recognition::extensions::passage::is_sure`]).
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

    /// Returns the `most` heaviest valid anchors that are wanted, by weight; the nearest ones are the heaviest.
    pub fn heaviest(&self, most: usize, is_wanted: impl Fn(&LocalAnchor) -> bool) -> Vec<&LocalAnchor> {
        let mut anchors: Vec<&LocalAnchor> = self.valid().filter(|anchor| is_wanted(anchor)).collect();
        anchors.sort_by(|a, b| b.weight.total_cmp(&a.weight).then_with(|| a.name.cmp(&b.name)));
        anchors.truncate(most);
        anchors
    }

    /// Returns how many anchors nothing has described yet.
    pub fn pending(&self) -> usize {
        self.anchors.iter().filter(|anchor| anchor.state == AnchorState::Pending).count()
    }
}

/// What a local anchor map is built around: a keyframe of the map, or one that is not stored.
#[derive(Clone, Debug)]
pub struct Centre {
    /// The session whose frame the poses are in; unknown to the map if it is an inline keyframe's new one.
    pub session: Option<SessionSeq>,
    /// `map_from_camera` of the keyframe.
    pub map_from_camera: Pose,
    /// K_k^cov: the covisible keyframes, and the keyframe itself if it is stored.
    pub covisible: BTreeSet<KeyframeSeq>,
    /// What the keyframe sees that the map has no anchor for.
    pub inline: Vec<InlineAnchor>,
}

/// A detection of an inline keyframe that belongs to no anchor of the map.
#[derive(Clone, Debug)]
pub struct InlineAnchor {
    /// Its place in the list of detections.
    pub detection: usize,
    /// Its class.
    pub class: Box<str>,
    /// What was read, parsed.
    pub text: Option<Arc<Text>>,
    /// Whether a model or a person described it.
    pub described: bool,
    /// Whether the reader was not confident, and nothing else of the map was read alike.
    pub doubtful: bool,
    /// Where it stands, in the session's frame.
    pub centre_in_session: Point3,
    /// Whether nothing measured how far that is.
    pub range_assumed: bool,
}

impl InlineAnchor {
    /// InformationLevel of what was read, 1 where that is doubtful; none if nothing was.
    pub fn information_level(&self) -> Option<u8> {
        let text = self.text.as_ref()?;
        Some(if self.doubtful { 1 } else { text.information_level() })
    }
}

impl Centre {
    /// Around a keyframe of the map.
    pub fn stored(index: &MapIndex, keyframe: KeyframeSeq) -> Option<Self> {
        let stored = index.keyframe(keyframe)?;
        Some(Self {
            session: Some(stored.session),
            map_from_camera: stored.map_from_camera,
            covisible: index.covisibility().with_itself(keyframe).collect(),
            inline: Vec::new(),
        })
    }
}

/// Builds M_k.
pub fn local_anchor_map(index: &MapIndex, centre: &Centre, places: &mut PlaceCounts) -> LocalAnchorMap {
    let context = index.covisibility().around(&centre.covisible);
    let roots: BTreeSet<AnchorSeq> =
        context.into_iter().flat_map(|keyframe| index.objects_seen_by(keyframe)).collect();
    let stored = roots.into_iter().filter_map(|root| stored_anchor(index, centre, root, places));
    let mut anchors: Vec<LocalAnchor> = stored.collect();
    anchors.extend(centre.inline.iter().map(|inline| inline_anchor(index, centre, inline, places)));
    LocalAnchorMap { session: centre.session, anchors }
}

fn stored_anchor(
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
        text_id,
        certainty: object
            .description
            .as_ref()
            .map_or(Certainty::ReadOnce, |description| description.certainty),
        centre_in_session,
        bearing,
        range_assumed,
        weight: weight(index, &bearing, range_assumed, places),
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
        description: inline.text.as_ref().map(|text| text.normalised().into()),
        text: inline.text.clone(),
        text_id,
        certainty: if inline.described { Certainty::Sure } else { Certainty::ReadOnce },
        centre_in_session: inline.centre_in_session,
        bearing,
        range_assumed: inline.range_assumed,
        weight: weight(index, &bearing, inline.range_assumed, places),
        places,
    }
}

/// 1/d of §V-B, bounded by the least distance, and 1 where d was assumed (M26); divided by p with distinctive
/// weights (M6).
fn weight(index: &MapIndex, bearing: &Bearing, range_assumed: bool, places: usize) -> f64 {
    if range_assumed {
        return 1.0 / places as f64;
    }
    let least_m = index.properties().settings.anchor_map_min_distance_m;
    1.0 / bearing.distance_m().max(least_m) / places as f64
}

/// p of M6, counted only if the map's settings ask for it.
fn places_at(index: &MapIndex, count: impl FnOnce() -> usize) -> usize {
    if index.properties().settings.distinctive_weights { count() } else { 1 }
}

/// Associates an inline keyframe's detections as ingest would, and changes nothing: those that
/// track an object add nothing to the map's knowledge of it, the others stand for themselves.
/// Returns the centre and the objects that the keyframe sees.
pub fn inline_centre(
    index: &MapIndex,
    keyframe: &NewKeyframe,
    covisible: BTreeSet<KeyframeSeq>,
) -> (Centre, BTreeSet<AnchorSeq>) {
    let session = index.session(&keyframe.session);
    let sent: BTreeMap<_, _> = keyframe.map_points.iter().copied().collect();
    let position = |id: PointId| sent.get(&id).copied().or_else(|| index.points().position(session?, id));
    let associations = associate(index, session, covisible.iter().copied(), &keyframe.detections, position);
    let min_confidence = index.properties().settings.reading_min_confidence;
    let (mut inline, mut seen) = (Vec::new(), BTreeSet::new());
    for (number, (detection, association)) in keyframe.detections.iter().zip(associations).enumerate() {
        match association {
            Association::Ignored(_) => {}
            Association::Tracked(root) => drop(seen.insert(root)),
            Association::New => {
                let placed = detection.map_points.iter().filter_map(|id| position(*id));
                let centre = crate::geometry::Aabb::around(placed).map(|aabb| aabb.centre());
                let Some(centre_in_session) = centre.or(detection.position_in_session) else { continue };
                let range_assumed = centre.is_none() && detection.range_assumed;
                let class = detection.class.as_str();
                let numbering = index.readings().numbering(class);
                let text = detection.reading().map(|reading| Text::under(reading, numbering));
                let described = detection.description.is_some();
                let unsure = !described && detection.confidence < min_confidence;
                let is_alone = |text: &Text| !text.is_described() && !index.readings().is_known(class, text);
                inline.push(InlineAnchor {
                    detection: number,
                    class: class.into(),
                    doubtful: unsure && text.as_ref().is_some_and(is_alone),
                    text: text.map(Arc::new),
                    described,
                    centre_in_session,
                    range_assumed,
                });
            }
        }
    }
    (Centre { session, map_from_camera: keyframe.map_from_camera, covisible, inline }, seen)
}
