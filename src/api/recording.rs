//! Recording: a map's operations as lines that `replay` plays. Each bears a body as a client posts it.

use serde::Serialize;

use super::anchor::AnchorPatchBody;
use super::keyframe::KeyframeBody;
use super::loops::LoopBody;
use super::map::MapPatchBody;
use super::model_verdict::ModelVerdictBody;
use super::observations::ObservationsBody;
use super::poses::PosesBody;
use super::prior::PriorBody;
use super::session_merge::MergeBody;
use crate::domain::ids::MapId;
use crate::domain::recorded::{NamedDetection, Recorded};

/// A line. What it names is left out where it names none.
#[derive(Serialize)]
struct Line<B> {
    op: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    id: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    keyframe: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    detection: Option<u16>,
    #[serde(skip_serializing_if = "Option::is_none")]
    session: Option<String>,
    #[serde(rename = "loop", skip_serializing_if = "Option::is_none")]
    closed: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    anchor: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    body: Option<B>,
}

impl<B: Serialize> Line<B> {
    fn of(op: &'static str, body: impl Into<Option<B>>) -> Self {
        let (keyframe, session, detection, closed, anchor) = (None, None, None, None, None);
        Self { op, id: None, keyframe, session, detection, closed, anchor, body: body.into() }
    }

    fn at(self, detection: NamedDetection) -> Self {
        let keyframe = Some(detection.keyframe.to_string());
        Self { keyframe, detection: Some(detection.number), ..self }
    }

    fn write(&self, to: &mut Vec<u8>) -> Result<(), serde_json::Error> {
        serde_json::to_writer(&mut *to, self)?;
        to.push(b'\n');
        Ok(())
    }
}

/// Appends the line of an operation on a map.
pub fn write_line(map: &MapId, recorded: Recorded, to: &mut Vec<u8>) -> Result<(), serde_json::Error> {
    match recorded {
        Recorded::Map(patch) => {
            Line { id: Some(map.to_string()), ..Line::of("map", MapPatchBody::from(patch)) }.write(to)
        }
        Recorded::Keyframe(keyframe) => {
            let id = Some(keyframe.id.to_string());
            Line { id, ..Line::of("keyframe", KeyframeBody::from(*keyframe)) }.write(to)
        }
        Recorded::Poses(correction) => Line::of("poses", PosesBody::from(correction)).write(to),
        Recorded::Observations(changed) => {
            Line::of("observations", ObservationsBody::from(changed)).write(to)
        }
        Recorded::SessionsMerged(merge) => {
            let session = Some(merge.session.to_string());
            Line { session, ..Line::of("merge_sessions", MergeBody::from(merge)) }.write(to)
        }
        Recorded::MergeRevoked(session) => {
            Line::<()> { session: Some(session.to_string()), ..Line::of("delete", None) }.write(to)
        }
        Recorded::Loop(closed) => Line::of("loop", LoopBody::from(closed)).write(to),
        Recorded::LoopRevoked(id) => {
            Line::<()> { closed: Some(id.to_string()), ..Line::of("delete", None) }.write(to)
        }
        Recorded::Description { detection, text } => {
            Line::of("description", AnchorPatchBody { description: text }).at(detection).write(to)
        }
        Recorded::AnchorDeleted(detection) => Line::<()>::of("delete", None).at(detection).write(to),
        Recorded::Prior(prior) => {
            Line { id: Some(prior.id.to_string()), ..Line::of("anchor", PriorBody::from(prior)) }.write(to)
        }
        Recorded::PriorDeleted(id) => {
            Line::<()> { anchor: Some(id.to_string()), ..Line::of("delete", None) }.write(to)
        }
        Recorded::Judged(verdict) => Line::of("judgement", ModelVerdictBody::from(verdict)).write(to),
        Recorded::CropRead { detection, reading } => {
            Line::of("judgement", ModelVerdictBody::from((detection, reading))).write(to)
        }
    }
}
