//! Recording: a map's operations as lines that `replay` plays. Each bears a body as a client posts it.

use revisit_core::domain::ids::MapId;
use revisit_core::domain::recorded::{NamedDetection, Recorded};
use serde::Serialize;
use serde::ser::{SerializeMap as _, Serializer as _};
use serde_json::{Value, json};

use super::anchor::AnchorPatchBody;
use super::keyframe::KeyframeBody;
use super::loops::LoopBody;
use super::map::MapPatchBody;
use super::model_verdict::ModelVerdictBody;
use super::observations::ObservationsBody;
use super::poses::PosesBody;
use super::prior::PriorBody;
use super::session_merge::MergeBody;

/// The body of an operation that names all it is about.
const NO_BODY: Option<()> = None;

/// Appends a line: an operation, what it names, and its body.
fn line<B: Serialize>(
    to: &mut Vec<u8>,
    op: &str,
    names: &[(&str, Value)],
    body: Option<B>,
) -> Result<(), serde_json::Error> {
    let mut json = serde_json::Serializer::new(&mut *to);
    let mut line = json.serialize_map(None)?;
    line.serialize_entry("op", op)?;
    for (name, value) in names {
        line.serialize_entry(name, value)?;
    }
    if let Some(body) = body {
        line.serialize_entry("body", &body)?;
    }
    line.end()?;
    to.push(b'\n');
    Ok(())
}

fn place(of: &NamedDetection) -> [(&'static str, Value); 2] {
    [("keyframe", json!(of.keyframe)), ("detection", json!(of.number))]
}

/// Appends the line of an operation on a map.
pub fn write_line(map: &MapId, recorded: Recorded, to: &mut Vec<u8>) -> Result<(), serde_json::Error> {
    match recorded {
        Recorded::Map(patch) => line(to, "map", &[("id", json!(map))], Some(MapPatchBody::from(patch))),
        Recorded::Keyframe(keyframe) => {
            let id = json!(keyframe.id);
            line(to, "keyframe", &[("id", id)], Some(KeyframeBody::from(*keyframe)))
        }
        Recorded::Poses(correction) => line(to, "poses", &[], Some(PosesBody::from(correction))),
        Recorded::Observations(changed) => {
            line(to, "observations", &[], Some(ObservationsBody::from(changed)))
        }
        Recorded::SessionsMerged(merge) => {
            let session = json!(merge.session);
            line(to, "merge_sessions", &[("session", session)], Some(MergeBody::from(merge)))
        }
        Recorded::MergeRevoked(session) => line(to, "delete", &[("session", json!(session))], NO_BODY),
        Recorded::Loop(closed) => line(to, "loop", &[], Some(LoopBody::from(closed))),
        Recorded::LoopRevoked(id) => line(to, "delete", &[("loop", json!(id))], NO_BODY),
        Recorded::Description { detection, text } => {
            line(to, "description", &place(&detection), Some(AnchorPatchBody { description: text }))
        }
        Recorded::AnchorDeleted(detection) => line(to, "delete", &place(&detection), NO_BODY),
        Recorded::Prior(prior) => {
            let id = json!(prior.id);
            line(to, "anchor", &[("id", id)], Some(PriorBody::from(prior)))
        }
        Recorded::PriorDeleted(id) => line(to, "delete", &[("anchor", json!(id))], NO_BODY),
        Recorded::Judged(verdict) => line(to, "judgement", &[], Some(ModelVerdictBody::from(verdict))),
        Recorded::CropRead { detection, reading } => {
            line(to, "judgement", &[], Some(ModelVerdictBody::from((detection, reading))))
        }
    }
}
