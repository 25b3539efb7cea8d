//! Keyframes and detections to be sent, built word by word.

use revisit_core::domain::global_descriptor::{GlobalDescriptor, GlobalEncoding};
use revisit_core::domain::ids::PointId;
use revisit_core::domain::keyframe::CLIENTS_VOCABULARY;
use revisit_core::geometry::Pose;
use revisit_core::{BowVector, Camera, Detection, Features, NewKeyframe, Stamp};

use super::{keyframe_id, turned};

/// A keyframe to be sent.
#[derive(Clone)]
pub struct Keyframe(NewKeyframe);

/// Makes a keyframe at the origin that looks along z, with the word 1.
pub fn keyframe() -> Keyframe {
    let stamp = Stamp { sec: 1, nanosec: 0 };
    let new = NewKeyframe::at(keyframe_id("unnamed"), stamp, Pose::identity());
    Keyframe(NewKeyframe { covisible: Some(Vec::new()), ..new }).words(&[(1, 1.0)])
}

impl Keyframe {
    /// Names it, and joins what it lists with what its features see, as a client's keyframe is read.
    pub(super) fn under(self, id: &str) -> NewKeyframe {
        let mut new = self.0;
        new.id = keyframe_id(id);
        let seen = new.features.iter().flat_map(|features| features.map_points.iter().flatten());
        let seen: Vec<PointId> = seen.copied().collect();
        new.observes.extend(seen);
        new.observes = ascending(new.observes);
        new
    }

    pub fn words(mut self, words: &[(u32, f64)]) -> Self {
        self.0.bow = BowVector::normalised(words.to_vec()).expect("words");
        self.0.vocabulary = Some(CLIENTS_VOCABULARY.into());
        self
    }

    /// Its whole image is these numbers to a model.
    pub fn global(mut self, numbers: &[i8]) -> Self {
        self.0.global_descriptor = Some(GlobalDescriptor {
            model: "test".parse().expect("an id"),
            encoding: GlobalEncoding::Int8,
            data: numbers.iter().map(|number| *number as u8).collect(),
        });
        self
    }

    pub fn session(mut self, session: &str) -> Self {
        self.0.session = session.parse().expect("an id");
        self
    }

    /// It was taken then.
    pub fn stamp(mut self, sec: i64) -> Self {
        self.0.stamp = Stamp { sec, nanosec: 0 };
        self
    }

    /// It stands there, not turned.
    pub fn at(self, place: [f64; 3]) -> Self {
        self.turned(place, [0.0, 0.0, 0.0, 1.0])
    }

    /// It stands there, turned by a quaternion `[x,y,z,w]`.
    pub fn turned(mut self, place: [f64; 3], rotation: [f64; 4]) -> Self {
        self.0.map_from_camera = turned(place, rotation);
        self
    }

    /// Its client does not know what is covisible with it.
    pub fn unlinked(mut self) -> Self {
        self.0.covisible = None;
        self
    }

    /// Its client declares these covisible, with 40 shared points.
    pub fn covisible(self, keyframes: &[&str]) -> Self {
        self.sharing(keyframes, 40)
    }

    /// Its client declares these covisible, with so many shared points.
    pub fn sharing(mut self, keyframes: &[&str], shared: u32) -> Self {
        self.0.covisible = Some(keyframes.iter().map(|id| (keyframe_id(id), shared)).collect());
        self
    }

    pub fn camera(mut self, camera: Camera) -> Self {
        self.0.camera = Some(camera);
        self
    }

    pub fn features(mut self, features: Features) -> Self {
        self.0.features = Some(features);
        self
    }

    pub fn observes(mut self, points: impl IntoIterator<Item = PointId>) -> Self {
        self.0.observes = points.into_iter().collect();
        self
    }

    /// It brings these map points.
    pub fn points(mut self, points: &[(PointId, [f64; 3])]) -> Self {
        self.0.map_points = points.iter().map(|(id, at)| (*id, (*at).into())).collect();
        self.0.map_points.sort_unstable_by_key(|(id, _)| *id);
        self
    }

    pub fn sees(mut self, things: impl IntoIterator<Item = Thing>) -> Self {
        self.0.detections = things.into_iter().map(|thing| thing.0).collect();
        self
    }
}

/// A thing that a keyframe sees: a detection to be sent.
#[derive(Clone)]
pub struct Thing(Detection);

/// Makes a thing of a class, seen with full confidence, not yet anywhere.
pub fn thing(class: &str, text: &str) -> Thing {
    let text = Some(text.to_owned()).filter(|text| !text.is_empty());
    Thing(Detection { text, ..Detection::of(class, 1.0, [0.0, 0.0, 10.0, 10.0]) })
}

/// Makes a door plate at a position.
pub fn door(text: &str, position: [f64; 3]) -> Thing {
    thing("door_number", text).at(position)
}

/// Makes a door plate that nobody has read.
pub fn unread(position: [f64; 3]) -> Thing {
    door("", position)
}

impl Thing {
    pub fn at(mut self, position: [f64; 3]) -> Self {
        self.0.position_in_session = Some(position.into());
        self
    }

    /// Its place is these map points.
    pub fn on(mut self, points: impl IntoIterator<Item = PointId>) -> Self {
        self.0.map_points = ascending(points.into_iter().collect());
        self
    }

    pub fn confidence(mut self, confidence: f64) -> Self {
        self.0.confidence = confidence;
        self
    }

    pub fn described(mut self, description: &str) -> Self {
        self.0.description = Some(description.to_owned());
        self
    }

    /// Nothing measured how far it is.
    pub fn at_a_guess(mut self) -> Self {
        self.0.range_assumed = true;
        self
    }
}

/// Returns a set of map points in the order in which keyframes and detections keep them.
fn ascending(mut points: Vec<PointId>) -> Vec<PointId> {
    points.sort_unstable();
    points.dedup();
    points
}
