//! Digest of a keyframe's facts: what makes two bodies the same, whatever their form, order and spelling.
//!
//! BLAKE3 over the fields in a fixed order, numbers in little-endian form, each text and each list preceded by its length.
//! Digests are kept on disk and compared with those of bodies sent years later. The golden value of `api::tests` holds
//! their form in place.

use revisit_core::domain::bow::BowVector;
use revisit_core::domain::global_descriptor::GlobalDescriptor;
use revisit_core::domain::keyframe::{Camera, Crop, Detection, Features, Keypoint, NewKeyframe, Stamp};
use revisit_core::domain::request::Digest;
use revisit_core::geometry::{Point3, Pose};

/// Returns the digest of a keyframe, without its name: that stands in the path.
pub fn of(keyframe: &NewKeyframe) -> Digest {
    let NewKeyframe {
        id: _,
        session,
        stamp: Stamp { sec, nanosec },
        map_from_camera,
        camera,
        gravity,
        height_m,
        bow,
        vocabulary,
        global_descriptor,
        features,
        map_points,
        observes,
        covisible,
        detections,
    } = keyframe;
    let mut facts = Facts(Vec::with_capacity(room(keyframe)));
    facts.text(session.as_str());
    facts.bytes(&sec.to_le_bytes());
    facts.bytes(&nanosec.to_le_bytes());
    facts.pose(map_from_camera);
    facts.option(camera.as_ref(), Facts::camera);
    facts.bow(bow);
    facts.option(vocabulary.as_deref(), Facts::text);
    facts.option(features.as_ref(), Facts::features);
    facts.list(map_points, |facts, (id, at)| {
        facts.bytes(&id.to_le_bytes());
        facts.point(at);
    });
    facts.list(observes, |facts, id| facts.bytes(&id.to_le_bytes()));
    facts.option(covisible.as_ref(), |facts, listed| {
        facts.list(listed, |facts, (other, shared)| {
            facts.text(other.as_str());
            facts.bytes(&shared.to_le_bytes());
        });
    });
    facts.list(detections, Facts::detection);
    facts.option(gravity.as_ref(), |facts, gravity| facts.floats(&gravity.as_given()));
    facts.option(global_descriptor.as_ref(), Facts::global_descriptor);
    // Digests from before there was this field stay what they are.
    if let Some(height_m) = height_m {
        facts.float(*height_m);
    }
    // Not SHA-256, as elsewhere: of 100 kB it takes 55 us, or 257 us on a processor without instructions for it, and BLAKE3 17 us.
    blake3::hash(&facts.0).into()
}

/// Returns the bytes of the facts, about.
fn room(keyframe: &NewKeyframe) -> usize {
    let features = keyframe.features.as_ref().map_or(0, |of| of.descriptors.len() + 40 * of.keypoints.len());
    let crops = keyframe.detections.iter().filter_map(|detection| detection.crop.as_ref());
    1024 + features
        + 8 * keyframe.bow.words().len()
        + 32 * keyframe.map_points.len()
        + 8 * keyframe.observes.len()
        + crops.map(|crop| 1024 + crop.bytes.len()).sum::<usize>()
}

/// Facts, written one after the other.
struct Facts(Vec<u8>);

impl Facts {
    fn bytes(&mut self, bytes: &[u8]) {
        self.0.extend_from_slice(bytes);
    }

    fn length(&mut self, length: usize) {
        self.bytes(&(length as u64).to_le_bytes());
    }

    fn text(&mut self, text: &str) {
        self.length(text.len());
        self.bytes(text.as_bytes());
    }

    fn float(&mut self, number: f64) {
        self.bytes(&number.to_le_bytes());
    }

    fn floats(&mut self, numbers: &[f64]) {
        for number in numbers {
            self.float(*number);
        }
    }

    fn list<T>(&mut self, items: &[T], mut write: impl FnMut(&mut Self, &T)) {
        self.length(items.len());
        for item in items {
            write(self, item);
        }
    }

    fn option<T>(&mut self, value: Option<T>, write: impl FnOnce(&mut Self, T)) {
        self.bytes(&[u8::from(value.is_some())]);
        if let Some(value) = value {
            write(self, value);
        }
    }

    fn global_descriptor(&mut self, descriptor: &GlobalDescriptor) {
        let GlobalDescriptor { model, encoding, data } = descriptor;
        self.text(model.as_str());
        self.text(encoding.as_str());
        self.length(data.len());
        self.bytes(data);
    }

    fn pose(&mut self, pose: &Pose) {
        self.floats(&pose.translation_m());
        self.floats(&pose.rotation_xyzw());
    }

    fn point(&mut self, at: &Point3) {
        self.floats(&[at.x, at.y, at.z]);
    }

    fn camera(&mut self, camera: &Camera) {
        let Camera { fx, fy, cx, cy, width, height } = camera;
        self.floats(&[*fx, *fy, *cx, *cy]);
        self.bytes(&width.to_le_bytes());
        self.bytes(&height.to_le_bytes());
    }

    fn bow(&mut self, bow: &BowVector) {
        self.list(bow.words(), |facts, word| facts.bytes(&word.to_le_bytes()));
        self.list(bow.weights(), |facts, weight| facts.bytes(&weight.to_le_bytes()));
    }

    fn features(&mut self, features: &Features) {
        let Features { descriptor_bytes, descriptors, keypoints, map_points } = features;
        self.length(*descriptor_bytes);
        self.length(descriptors.len());
        self.bytes(descriptors);
        self.list(keypoints, |facts, Keypoint { u, v, octave, angle_deg }| {
            facts.floats(&[*u, *v, angle_deg.unwrap_or(f64::INFINITY)]);
            facts.bytes(&[*octave]);
        });
        self.list(map_points, |facts, id| facts.bytes(&id.unwrap_or(-1).to_le_bytes()));
    }

    fn detection(&mut self, detection: &Detection) {
        let Detection {
            class,
            confidence,
            box_px,
            map_points,
            position_in_session,
            range_assumed,
            text,
            description,
            crop,
        } = detection;
        self.text(class);
        self.float(*confidence);
        self.floats(box_px);
        self.list(map_points, |facts, id| facts.bytes(&id.to_le_bytes()));
        self.option(position_in_session.as_ref(), Self::point);
        self.bytes(&[u8::from(*range_assumed)]);
        self.option(text.as_deref(), Self::text);
        self.option(description.as_deref(), Self::text);
        // Its type follows from its bytes.
        self.option(crop.as_ref(), |facts, Crop { media_type: _, bytes }| {
            facts.length(bytes.len());
            facts.bytes(bytes);
        });
    }
}
