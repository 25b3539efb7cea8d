//! Keyframes as they were sent: the model back in the shape in which a client sends it.

use std::collections::HashSet;

use revisit_core::domain::bow::BowVector;
use revisit_core::domain::ids::PointId;
use revisit_core::domain::keyframe::{CLIENTS_VOCABULARY, NewKeyframe};
use revisit_core::geometry::Point3;

use super::shape::{BowShape, FeaturesShape, KeyframeBody, PointsShape, filled};
use crate::shown::Shown;
use crate::space::Position;

impl From<NewKeyframe> for KeyframeBody {
    fn from(keyframe: NewKeyframe) -> Self {
        // Features without words are sent so on purpose, or a server would compute some.
        let says_words = !keyframe.bow.is_empty() || keyframe.features.is_some();
        let NewKeyframe {
            bow, vocabulary, global_descriptor, features, observes, map_points, covisible, ..
        } = keyframe;
        let named: HashSet<PointId> =
            features.iter().flat_map(|features| features.map_points.iter().flatten().copied()).collect();
        let observes: Vec<i64> = observes.into_iter().filter(|id| !named.contains(id)).collect();
        Self {
            session: Some(keyframe.session),
            stamp: keyframe.stamp.into(),
            pose: keyframe.map_from_camera.into(),
            camera: keyframe.camera.map(Into::into),
            gravity: keyframe.gravity,
            height_m: keyframe.height_m,
            bow: says_words.then(|| exactly(&bow, vocabulary.map(Into::into).filter(is_named))),
            global_descriptor: global_descriptor.map(Into::into),
            features: features.map(|features| {
                let shape = FeaturesShape::from(features);
                FeaturesShape { map_points: shape.map_points.filter(|_| !named.is_empty()), ..shape }
            }),
            map_points: Shown::shown(filled(map_points)),
            observes: filled(observes),
            covisible: Shown::shown(covisible),
            detections: Shown::shown(filled(keyframe.detections)),
        }
    }
}

/// Whether a vocabulary has a name; words that came without one go without one.
pub(super) fn is_named(vocabulary: &String) -> bool {
    vocabulary != CLIENTS_VOCABULARY
}

/// Writes weights that are normalised to the same vector: as answers show them if that does, else every digit.
fn exactly(bow: &BowVector, vocabulary: Option<String>) -> BowShape {
    let shown = BowShape::from(bow);
    let entries = shown.words.iter().copied().zip(shown.weights.iter().copied());
    if BowVector::normalised(entries.collect()).as_ref() == Ok(bow) {
        return BowShape { vocabulary, ..shown };
    }
    let one = f64::from(BowVector::ONE);
    let weights = bow.weights().iter().map(|units| f64::from(*units) / one).collect();
    BowShape { words: shown.words, weights, vocabulary }
}

impl Shown<Vec<(PointId, Point3)>> for PointsShape {
    fn shown(points: Vec<(PointId, Point3)>) -> Self {
        let (ids, positions) = points.into_iter().map(|(id, at)| (id, Position(at.coords.into()))).unzip();
        Self { ids, positions }
    }
}
