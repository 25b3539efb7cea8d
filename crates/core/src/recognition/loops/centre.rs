//! The centre of a local anchor map (§V-A): a keyframe of the map, or one that is not stored (M50).

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use crate::domain::ids::{AnchorSeq, KeyframeSeq, PointId, SessionSeq};
use crate::domain::keyframe::NewKeyframe;
use crate::geometry::{Aabb, Point3, Pose};
use crate::recognition::anchors::association::{Association, associate};
use crate::recognition::map::index::MapIndex;
use crate::semantics::Text;

/// Centre of a local anchor map: a keyframe of the map, or one that is not stored.
#[derive(Clone, Debug)]
pub struct Centre {
    /// The session whose frame the poses are in; unknown to the map if it is an inline keyframe's new one.
    pub session: Option<SessionSeq>,
    /// `map_from_camera` of the keyframe.
    pub map_from_camera: Pose,
    /// K_k^cov: the covisible keyframes, and the keyframe itself if it is stored.
    pub covisible: BTreeSet<KeyframeSeq>,
    /// Detections of the keyframe that no anchor of the map covers.
    pub inline: Vec<InlineAnchor>,
}

/// A detection of an inline keyframe that belongs to no anchor of the map.
#[derive(Clone, Debug)]
pub struct InlineAnchor {
    /// Its place in the list of detections.
    pub detection: usize,
    /// Its class.
    pub class: Box<str>,
    /// The reading, as it was sent.
    pub raw: Option<Box<str>>,
    /// The parsed reading.
    pub text: Option<Arc<Text>>,
    /// Whether a model or a person described it.
    pub described: bool,
    /// The reader's confidence, 0 to 1.
    pub confidence: f64,
    /// Whether the reader was not confident, and nothing else of the map was read alike.
    pub doubtful: bool,
    /// Its place, in the session's frame.
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

/// Associates an inline keyframe's detections as ingest would, and changes nothing: those that
/// track an object add nothing to the map's knowledge of it, the others stand for themselves.
/// `session` is the one whose frame and numbers the keyframe has, if the map knows it. Returns the centre and the objects that the keyframe sees.
pub fn inline_centre(
    index: &MapIndex,
    session: Option<SessionSeq>,
    keyframe: &NewKeyframe,
    covisible: BTreeSet<KeyframeSeq>,
) -> (Centre, BTreeSet<AnchorSeq>) {
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
                let centre = Aabb::around(placed).map(|aabb| aabb.centre());
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
                    raw: detection.reading().map(Into::into),
                    text: text.map(Arc::new),
                    confidence: detection.confidence,
                    described,
                    centre_in_session,
                    range_assumed,
                });
            }
        }
    }
    (Centre { session, map_from_camera: keyframe.map_from_camera, covisible, inline }, seen)
}
