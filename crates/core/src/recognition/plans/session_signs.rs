//! Signs of a session: what its keyframes saw, and what the plans show with the same texts or similar ones.

use std::collections::BTreeMap;

use nalgebra::{Isometry3, UnitQuaternion, Vector2, Vector3};

use super::plan_texts::PlanTexts;
use super::signs::{DrawnSign, SeenSign, Signs};
use super::upright::{levelling, vertical};
use crate::domain::anchor::{AnchorState, Observation};
use crate::domain::ids::{AnchorSeq, SessionSeq};
use crate::geometry::{Aabb, Point3, Pose};
use crate::recognition::map::index::{MapIndex, MergedAnchor};
use crate::semantics::{self, Text};

/// Maximum signs of a session that are taken, the oldest.
const SEEN_MAX: usize = 512;

/// Standard deviation of one sighting of a sign along each axis: at no distance in metres, and for each metre of it.
pub(in crate::recognition) const SIGHTING_SIGMA_M: f64 = 0.3;
pub(in crate::recognition) const SIGHTING_SIGMA_PER_M: f64 = 0.03;

/// What all sightings of a sign share, in metres: the camera's own pose, and its calibration.
pub(in crate::recognition) const SHARED_SIGMA_M: f64 = 0.1;

/// Sightings of one text nearer than this are of one sign, in metres.
pub(in crate::recognition) const SAME_SIGN_M: f64 = 2.0;

/// A text that was read here half as often as another one, or less, is a misreading of that one, in metres.
pub(in crate::recognition) const SAME_SPOT_M: f64 = 1.2;

/// Directions of gravity of which the sum is shorter contradict each other.
const GRAVITY_MIN: f64 = 1e-6;

/// The cost of the assumption that a text was misread, as a logarithm: read once by a reader that was not confident, read once,
/// read alike twice, and more often or described.
const MISREAD_COSTS: [f64; 4] = [3.0, 4.0, 6.0, 8.0];

/// InformationLevel of texts that are looked up in the plans: general words are, and noise is not.
const LEVEL_MIN: u8 = 2;

/// The signs of a session, levelled, with the frames of the plans by number.
#[derive(Clone, Debug, PartialEq)]
pub struct SessionSigns {
    /// The signs.
    pub signs: Signs,
    /// The frames of the plans.
    pub frames: Vec<SessionSeq>,
    /// The rotation that brings the session's vertical to z.
    pub level_from_session: Isometry3<f64>,
}

/// Returns the signs of a session; none if the plans show none of its texts.
pub fn session_signs(index: &MapIndex, texts: &PlanTexts, session: SessionSeq) -> Option<SessionSigns> {
    let groups = groups(index, session);
    let cameras = || groups.iter().flat_map(|group| group.sightings.iter());
    let of_map = index.properties().gravity.map(|gravity| gravity.direction());
    let told =
        cameras().filter_map(|sighting| sighting.down).sum::<Vector3<f64>>().try_normalize(GRAVITY_MIN);
    let up = of_map.or(told).map(|down| -down);
    let level = levelling(&up.unwrap_or_else(|| vertical(cameras().map(|sighting| sighting.camera))));
    let mut drawn = Drawn { index, numbers: BTreeMap::new(), signs: Vec::new(), frames: frames(index) };
    let seen: Vec<SeenSign> = groups.iter().map(|group| group.seen(texts, &mut drawn, level)).collect();
    if seen.iter().all(|seen| seen.same.is_empty()) {
        return None;
    }
    let level_from_session = Isometry3::from_parts(nalgebra::Translation3::default(), level);
    Some(SessionSigns { signs: Signs { seen, drawn: drawn.signs }, frames: drawn.frames, level_from_session })
}

fn frames(index: &MapIndex) -> Vec<SessionSeq> {
    index.priors().frames().map(|(frame, _)| frame).collect()
}

/// One sighting of a sign.
#[derive(Clone, Copy)]
struct Sighting {
    position: Point3,
    camera: Pose,
    /// The direction of gravity in the session's frame, if the keyframe tells it.
    down: Option<Vector3<f64>>,
}

impl Sighting {
    fn variance(&self) -> f64 {
        let distance_m = (self.position - self.camera.centre()).norm();
        let sigma_m = SIGHTING_SIGMA_M + SIGHTING_SIGMA_PER_M * distance_m;
        sigma_m * sigma_m
    }
}

/// Objects that are one sign: they bear one text and stand together.
struct Group<'a> {
    class: &'a str,
    text: &'a Text,
    sightings: Vec<Sighting>,
    reads: usize,
    is_described: bool,
    /// Whether a reader that was not confident read it once.
    is_doubtful: bool,
}

/// Returns the signs that a session saw and that say anything, in the order of their anchors.
fn groups(index: &MapIndex, session: SessionSeq) -> Vec<Group<'_>> {
    let mut groups: Vec<Group<'_>> = Vec::new();
    for (root, object) in index.objects().iter() {
        let is_here = object.shapes.get(&session).is_some_and(|shape| shape.aabb.is_some());
        if !is_here || index.anchor(root).is_some_and(|anchor| anchor.prior.is_some()) {
            continue;
        }
        let Some(group) = Group::of(index, object, session) else { continue };
        if let Some(known) = groups.iter_mut().find(|known| known.is_same_sign(&group)) {
            known.join(group);
        } else if groups.len() < SEEN_MAX {
            groups.push(group);
        }
    }
    without_outvoted(groups)
}

/// Returns the groups without those that are misreadings of a sign at the same spot, which was read otherwise more often.
fn without_outvoted(groups: Vec<Group<'_>>) -> Vec<Group<'_>> {
    let means: Vec<Option<Vector3<f64>>> =
        groups.iter().map(|group| mean(&group.sightings).map(|(mean, _)| mean)).collect();
    let outvotes = |other: usize, group: usize| {
        let (by, of) = (&groups[other], &groups[group]);
        let is_weaker = !of.is_described && 2 * of.reads <= by.reads;
        let is_here = means[other].zip(means[group]).is_some_and(|(a, b)| (a - b).norm() <= SAME_SPOT_M);
        is_weaker && is_here
    };
    let is_outvoted: Vec<bool> = (0..groups.len())
        .map(|group| (0..groups.len()).any(|other| other != group && outvotes(other, group)))
        .collect();
    groups
        .into_iter()
        .zip(is_outvoted)
        .filter(|(_, is_outvoted)| !is_outvoted)
        .map(|(group, _)| group)
        .collect()
}

/// Returns the sightings of an object in one session of which something measured the distance.
fn sightings(index: &MapIndex, object: &MergedAnchor, session: SessionSeq) -> Vec<Sighting> {
    let observations = index.anchors_of(object).flat_map(|anchor| anchor.observations.values());
    let sighting = |observation: &Observation| {
        let keyframe = index.keyframe(observation.keyframe).filter(|keyframe| keyframe.session == session)?;
        let points = observation.map_points.iter().filter_map(|id| index.points().position(session, *id));
        let of_points = Aabb::around(points).map(|aabb| aabb.centre());
        let measured = observation.position_as_sent.filter(|_| !observation.range_assumed);
        let measured = measured.map(|sent| keyframe.position_now(sent));
        let camera = keyframe.map_from_camera;
        let down = keyframe.gravity.map(|gravity| camera.isometry().rotation * gravity.direction());
        Some(Sighting { position: of_points.or(measured)?, camera, down })
    };
    observations.filter_map(sighting).collect()
}

/// Returns the weighted mean of sightings, and its variance along each axis.
fn mean(sightings: &[Sighting]) -> Option<(Vector3<f64>, f64)> {
    let weight: f64 = sightings.iter().map(|sighting| 1.0 / sighting.variance()).sum();
    let sum: Vector3<f64> =
        sightings.iter().map(|sighting| sighting.position.coords / sighting.variance()).sum();
    (weight > 0.0).then(|| (sum / weight, 1.0 / weight + SHARED_SIGMA_M * SHARED_SIGMA_M))
}

impl<'a> Group<'a> {
    /// Returns an object as a session saw it; none if its text says nothing or it no longer hangs there.
    fn of(index: &'a MapIndex, object: &'a MergedAnchor, session: SessionSeq) -> Option<Self> {
        let description = object.description.as_ref().filter(|_| object.state != AnchorState::Retired)?;
        if description.text.information_level() < LEVEL_MIN {
            return None;
        }
        let sightings = sightings(index, object, session);
        let elected = object.votes.elected(index.readings().numbering(index.class_of(object)));
        Some(Self {
            class: index.class_of(object),
            text: &description.text,
            reads: elected.as_ref().map_or(1, |elected| elected.count),
            is_described: description.by_hand || elected.is_some_and(|elected| elected.described),
            is_doubtful: description.information_level < LEVEL_MIN,
            sightings,
        })
        .filter(|group| !group.sightings.is_empty())
    }

    fn is_same_sign(&self, other: &Self) -> bool {
        let is_here = || mean(&self.sightings).zip(mean(&other.sightings)).map(|(a, b)| (a.0 - b.0).norm());
        self.class == other.class
            && self.text.gist() == other.text.gist()
            && is_here().is_some_and(|apart_m| apart_m <= SAME_SIGN_M)
    }

    fn join(&mut self, other: Self) {
        self.sightings.extend(other.sightings);
        self.reads += other.reads;
        self.is_described |= other.is_described;
        self.is_doubtful = false;
    }

    fn misread_cost(&self) -> f64 {
        MISREAD_COSTS[match self.reads {
            _ if self.is_described => 3,
            0 | 1 => usize::from(!self.is_doubtful),
            reads => reads.min(3),
        }]
    }

    fn seen(&self, texts: &PlanTexts, drawn: &mut Drawn<'_>, level: UnitQuaternion<f64>) -> SeenSign {
        let (mean, variance) = mean(&self.sightings).unwrap_or((Vector3::zeros(), f64::MAX));
        let cameras = self.sightings.iter().map(|sighting| level * sighting.camera.centre().coords);
        let seen_from = cameras.sum::<Vector3<f64>>().xy() / self.sightings.len().max(1) as f64;
        let same = texts.same(drawn.index, self.class, self.text);
        let mut similar = texts.similar(self.class, self.text);
        similar.retain(|anchor| !same.contains(anchor));
        let same = drawn.numbers(&same);
        let is_distinctive = drawn.are_one_place(&same);
        SeenSign {
            position: level * mean,
            variance,
            seen_from,
            misread_cost: self.misread_cost(),
            same,
            similar: drawn.numbers(&similar),
            is_distinctive,
            is_specific: !semantics::is_common_sign(self.text),
        }
    }
}

/// The drawn signs that are taken so far, each once.
struct Drawn<'a> {
    index: &'a MapIndex,
    numbers: BTreeMap<AnchorSeq, usize>,
    signs: Vec<DrawnSign>,
    frames: Vec<SessionSeq>,
}

impl Drawn<'_> {
    /// Returns the numbers of those of the anchors that a plan shows.
    fn numbers(&mut self, anchors: &[AnchorSeq]) -> Vec<usize> {
        anchors.iter().filter_map(|anchor| self.number(*anchor)).collect()
    }

    fn number(&mut self, anchor: AnchorSeq) -> Option<usize> {
        if let Some(known) = self.numbers.get(&anchor) {
            return Some(*known);
        }
        let prior = self.index.anchor(anchor)?.prior.as_ref()?;
        let frame = self.frames.binary_search(&prior.frame).ok()?;
        let along_floor = prior.normal_in_frame.map(|[x, y, _]| Vector2::new(x, y));
        // A sign on the ceiling can be read from all around.
        let normal = along_floor.and_then(|normal| normal.try_normalize(0.5));
        let number = self.signs.len();
        self.signs.push(DrawnSign { frame, position: prior.position_in_frame.coords, normal });
        self.numbers.insert(anchor, number);
        Some(number)
    }

    /// Whether these are signs of one place: there are some, in one frame, within the radius of a place.
    fn are_one_place(&self, numbers: &[usize]) -> bool {
        let Some((first, others)) = numbers.split_first() else { return false };
        let first = &self.signs[*first];
        let radius_m = self.index.properties().settings.distinctive_place_radius_m;
        others
            .iter()
            .map(|other| &self.signs[*other])
            .all(|other| other.frame == first.frame && (other.position - first.position).norm() <= radius_m)
    }
}
