//! Frames: errors of the transformations of accepted loops, given where the sessions' frames lie.
//!
//! A recording of several robots may include a file with the pose of each session's frame in a common one. The true
//! camera-to-camera transformation then follows from the poses, and is compared with an answer's
//! `candidate_from_query`.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::latency::percentile;
use crate::api::geometry::Similarity;
use crate::api::space::Transform;
use crate::geometry::Pose;

/// The pose of each session's frame in a common one, and of each keyframe.
#[derive(Debug, Default)]
pub(super) struct Frames {
    common_from_session: BTreeMap<String, Pose>,
    common_from_camera: BTreeMap<(String, String), Pose>,
    errors: Vec<(f64, f64)>,
}

#[derive(Deserialize)]
struct FramesFile {
    common_from_session: BTreeMap<String, Transform>,
}

/// Errors of transformations.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(super) struct TransformErrors {
    /// Loops compared: accepted, true, with a transformation, in sessions whose frames are known.
    pub compared: usize,
    /// Between the two translations, in metres.
    pub translation_m: Spread,
    /// The angle between the two rotations, in degrees.
    pub rotation_deg: Spread,
}

/// The median and the upper end of a set of figures.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(super) struct Spread {
    pub median: f64,
    pub p90: f64,
}

impl Frames {
    /// Reads `{"common_from_session": {session: transform}}`.
    pub fn read(path: &Path) -> Result<Self, String> {
        let file = File::open(path).map_err(|error| format!("cannot read {}: {error}", path.display()))?;
        let read: FramesFile = serde_json::from_reader(BufReader::new(file))
            .map_err(|error| format!("{}: {error}", path.display()))?;
        let mut common_from_session = BTreeMap::new();
        for (session, transform) in read.common_from_session {
            let pose = transform.pose();
            let pose = pose.ok_or_else(|| format!("{}: {session} has no rotation", path.display()))?;
            common_from_session.insert(session, pose);
        }
        Ok(Self { common_from_session, ..Self::default() })
    }

    /// Records a sent keyframe.
    pub fn saw(&mut self, map: &str, id: &str, body: &serde_json::Map<String, Value>) {
        let session = body.get("session").and_then(Value::as_str).unwrap_or("default");
        let sent =
            body.get("pose").and_then(|pose| Transform::deserialize(pose).ok()).and_then(Transform::pose);
        if let (Some(common_from_session), Some(session_from_camera)) =
            (self.common_from_session.get(session), sent)
        {
            let common_from_camera = common_from_session.after(&session_from_camera);
            self.common_from_camera.insert((map.to_owned(), id.to_owned()), common_from_camera);
        }
    }

    /// Records a true loop that was found, with its transformation.
    pub fn found(&mut self, map: &str, query: &str, candidate: &str, candidate_from_query: &Similarity) {
        let camera = |id: &str| self.common_from_camera.get(&(map.to_owned(), id.to_owned()));
        let (Some(query), Some(candidate)) = (camera(query), camera(candidate)) else { return };
        let expected = candidate.inverse().after(query);
        let Similarity { translation, rotation, .. } = *candidate_from_query;
        let Some(answered) = (Transform { translation, rotation }).pose() else { return };
        let off = expected.inverse().after(&answered);
        let [.., w] = off.rotation_xyzw();
        let [a, b] = [expected, answered].map(|pose| pose.centre());
        self.errors.push(((a - b).norm(), 2.0 * w.abs().min(1.0).acos().to_degrees()));
    }

    /// Returns the errors; none if nothing could be compared.
    pub fn errors(&self) -> Option<TransformErrors> {
        let spread = |of: fn(&(f64, f64)) -> f64| {
            let mut sorted: Vec<f64> = self.errors.iter().map(of).collect();
            sorted.sort_by(f64::total_cmp);
            Some(Spread { median: percentile(&sorted, 50)?, p90: percentile(&sorted, 90)? })
        };
        Some(TransformErrors {
            compared: self.errors.len(),
            translation_m: spread(|error| error.0)?,
            rotation_deg: spread(|error| error.1)?,
        })
    }
}
