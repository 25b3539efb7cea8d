//! The answer: places with their evidence.

use revisit_core::domain::ids::MapId;
use revisit_core::domain::location::{Location, Place, Uncertainty};
use revisit_core::domain::look_for::LookFor;
use revisit_core::domain::request::Detail;
use revisit_shapes::answer;

use crate::geometry::GeometryView;
use crate::names::{AssumptionName, ChannelName, LocationVerdictName, PoseSourceName};
use crate::odds::EvidenceView;
use crate::space::{Transform, rounded};
use crate::verdict::{AnchorFigures, BowFigures, CandidateView, GlobalFigures, ReasonView};

/// The answer to "where am I?". The same versions of the maps, the same question and seed give the same bytes.
#[answer]
#[schema(as = LocateAnswer)]
pub struct LocateAnswerView {
    /// The answer.
    pub verdict: LocationVerdictName,
    /// One sentence for a person: why.
    #[serde(default)]
    pub why: String,
    /// The confidence that the camera is at the first place, 0 to 1; `located` is at least 0.99.
    #[schema(minimum = 0, maximum = 1)]
    pub confidence: f64,
    /// The places, best first. Where the verdict is not `located`, they are guesses.
    #[schema(max_items = 20)]
    pub places: Vec<PlaceView>,
    /// Where places are ambiguous: the signs that would tell them apart.
    #[schema(max_items = 8)]
    pub look_for: Vec<LookForView>,
    /// Why there is no place, or why the first one is not certain.
    pub reason: Option<ReasonView>,
    /// The maps that were asked, by name.
    #[schema(max_items = 64)]
    pub maps: Vec<AskedMapView>,
}

/// A place at which the camera may be.
#[answer]
#[schema(as = Place)]
pub struct PlaceView {
    /// The map.
    pub map: String,
    /// The map's keyframe that stands for the place; left out where only a plan's anchors say it.
    pub keyframe: Option<String>,
    /// The number of the asked keyframe, from 0, that was taken near `keyframe`; left out where one keyframe asks. The pose is
    /// the first one's all the same.
    #[schema(maximum = 15)]
    pub asked: Option<u32>,
    /// The session in whose frame `map_from_camera` is.
    pub session: String,
    /// Its standing in the answer.
    pub verdict: LocationVerdictName,
    /// The confidence that the camera is here, 0 to 1.
    #[schema(minimum = 0, maximum = 1)]
    pub confidence: f64,
    /// The terms of the sum of evidence, against the strongest other place; left out where there are none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub evidence: Vec<EvidenceView>,
    /// The camera's pose in the session's frame, in metres; left out where the evidence gives none.
    pub map_from_camera: Option<Transform>,
    /// The same in the frame of the plan to which the session is aligned.
    pub plan_from_camera: Option<Transform>,
    /// The plan's frame.
    pub plan: Option<String>,
    /// The standard deviation of that pose.
    pub uncertainty: Option<UncertaintyView>,
    /// The source of that pose.
    pub pose_source: Option<PoseSourceName>,
    /// The assumptions that it rests on; left out where there are none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schema(max_items = 1)]
    pub assumed: Vec<AssumptionName>,
    /// The signs that speak for the place and against it.
    pub signs: PlaceSignsView,
    /// Number of keyframes of this place that geometry verified.
    pub verified_views: u32,
    /// The channels that proposed the keyframe, where the question has a global descriptor.
    #[schema(max_items = 3)]
    pub channel: Option<Vec<ChannelName>>,
    /// Global descriptors.
    pub global: Option<GlobalFigures>,
    /// Bag of words.
    pub bow: Option<BowFigures>,
    /// Local anchor maps.
    pub anchors: Option<AnchorFigures>,
    /// Geometry.
    pub geometry: Option<GeometryView>,
    /// The check that stopped the keyframe as a loop candidate, if one did.
    pub reason: Option<ReasonView>,
}

/// The signs that speak for a place and against it.
#[answer]
#[schema(as = PlaceSigns)]
pub struct PlaceSignsView {
    /// The identifiers that agree and hang in one place only, as read.
    pub agreeing: Vec<String>,
    /// Number of pairs of identifiers that exclude each other at the same relative place.
    pub contradicting: u32,
}

/// The standard deviation of a pose.
#[answer(of = Uncertainty)]
#[derive(Copy)]
#[schema(as = Uncertainty)]
pub struct UncertaintyView {
    /// Of the position, in metres.
    #[rounded]
    pub translation_m: f64,
    /// Of the rotation, in radians.
    #[rounded]
    pub rotation_rad: f64,
}

/// A sign that would tell one of several places from the others.
#[answer]
#[schema(as = LookFor)]
pub struct LookForView {
    /// Its class.
    pub class: String,
    /// Its description.
    pub description: String,
    /// `[x,y,z]` in the frame of its place's session, in metres.
    #[schema(min_items = 3, max_items = 3)]
    pub position: [f64; 3],
    /// The map in which it hangs.
    pub map: String,
    /// The session in whose frame it is.
    pub session: String,
}

/// A map that was asked.
#[answer]
#[schema(as = AskedMap)]
pub struct AskedMapView {
    /// The map.
    pub map: String,
    /// The version that was asked.
    pub map_version: u64,
    /// Whether the words were compared: false where the map's are of another vocabulary.
    pub words_compared: bool,
}

impl LocateAnswerView {
    /// Returns the answer to so many keyframes, of these maps in the order in which they were asked.
    pub fn of(maps: Vec<AskedMapView>, keyframes: usize, location: &Location) -> Self {
        let of_place = |place| PlaceView::of(&maps, place, keyframes > 1);
        let places = location.places.iter().map(of_place).collect();
        let look_for = location.look_for.iter().filter_map(|sign| LookForView::of(&maps, location, sign));
        Self {
            verdict: location.verdict.into(),
            why: location.why.clone(),
            confidence: rounded(location.confidence),
            places,
            look_for: look_for.collect(),
            reason: location.reason.as_ref().map(ReasonView::from),
            maps,
        }
    }
}

impl AskedMapView {
    /// Returns a map that was asked.
    pub fn of(map: &MapId, map_version: u64, words_compared: bool) -> Self {
        // One that holds a release goes by the name of the map.
        Self { map: map.parts().0.to_owned(), map_version, words_compared }
    }
}

fn name_of(maps: &[AskedMapView], map: usize) -> String {
    maps.get(map).map_or_else(String::new, |asked| asked.map.clone())
}

impl PlaceView {
    fn of(maps: &[AskedMapView], place: &Place, are_several: bool) -> Self {
        let candidate = place.candidate.as_ref().map(|candidate| CandidateView::of(candidate, Detail::Full));
        let (channel, global, bow, anchors, geometry, reason) = match candidate {
            Some(of) => (of.channel, of.global, of.bow, of.anchors, Some(of.geometry), of.reason),
            None => Default::default(),
        };
        Self {
            map: name_of(maps, place.map),
            keyframe: place.keyframe.as_ref().map(ToString::to_string),
            asked: are_several.then_some(place.asked as u32),
            session: place.session.to_string(),
            verdict: place.verdict.into(),
            confidence: rounded(place.odds.confidence),
            evidence: place.odds.terms.iter().map(EvidenceView::from).collect(),
            map_from_camera: place.pose.as_ref().map(|pose| Transform::from(pose.map_from_camera)),
            plan_from_camera: place.in_plan.as_ref().map(|plan| Transform::from(plan.plan_from_camera)),
            plan: place.in_plan.as_ref().map(|plan| plan.frame.to_string()),
            uncertainty: place.pose.as_ref().map(|pose| UncertaintyView::from(pose.uncertainty)),
            pose_source: place.pose.as_ref().map(|pose| pose.source.into()),
            assumed: place.pose.iter().flat_map(|pose| &pose.assumed).map(|one| (*one).into()).collect(),
            signs: PlaceSignsView {
                agreeing: place.signs.agreeing.clone(),
                contradicting: place.signs.contradicting,
            },
            verified_views: place.verified_views,
            channel,
            global,
            bow,
            anchors,
            geometry,
            reason,
        }
    }
}

impl LookForView {
    fn of(maps: &[AskedMapView], location: &Location, LookFor { place, sign }: &LookFor) -> Option<Self> {
        let place = location.places.get(*place)?;
        Some(Self {
            class: sign.class.clone(),
            description: sign.description.clone(),
            position: [sign.position.x, sign.position.y, sign.position.z].map(rounded),
            map: name_of(maps, place.map),
            session: place.session.to_string(),
        })
    }
}
