//! Bulk: one line in, one line out.

use std::borrow::Cow;

use revisit_core::domain::ids::KeyframeId;
use revisit_shapes::answer;
use utoipa::openapi::{RefOr, Schema};
use utoipa::{PartialSchema, ToSchema};

use super::decoding::document::Json;
use super::keyframe::{Faulty, Keyframe, KeyframeAnswer, OutcomeView, SentKeyframe, of_line};
use super::names::Id;
use super::problem::ProblemView;

/// One line of a bulk request, for the API document: a keyframe with its id.
pub struct BulkItem;

impl ToSchema for BulkItem {
    fn name() -> Cow<'static, str> {
        "BulkItem".into()
    }
}

impl PartialSchema for BulkItem {
    fn schema() -> RefOr<Schema> {
        let mut keyframe = Keyframe::schema();
        if let RefOr::T(Schema::Object(object)) = &mut keyframe {
            object.description = Some("One line of a bulk request: a keyframe with its id.".to_owned());
            object.required.insert(0, "id".to_owned());
            object.properties.insert("id".to_owned(), Id::schema());
        }
        keyframe
    }
}

/// The outcome of one line of a bulk request.
#[answer]
#[derive(Default)]
pub struct BulkLine {
    /// The keyframe's id; left out where the line has none that can be read.
    pub id: Option<String>,
    /// The line's number in the request, from 1, blank lines counted.
    pub line: usize,
    /// The HTTP status that a request of its own would have got.
    pub status: u16,
    /// Whether the same keyframe was stored before.
    pub idempotent_replayed: Option<bool>,
    /// The map's version after it.
    pub map_version: Option<u64>,
    /// Number of keyframes covisible with it.
    pub covisible: Option<usize>,
    /// The outcomes of its detections, in their order.
    pub detections: Option<Vec<OutcomeView>>,
    /// The reason for its refusal.
    pub problem: Option<ProblemView>,
}

impl BulkLine {
    /// Returns a line that was stored.
    pub fn stored(line: usize, status: u16, replayed: bool, answer: KeyframeAnswer) -> Self {
        Self {
            id: Some(answer.keyframe),
            line,
            status,
            idempotent_replayed: replayed.then_some(true),
            map_version: Some(answer.map_version),
            covisible: Some(answer.covisible),
            detections: Some(answer.detections),
            problem: None,
        }
    }

    /// Returns a line that was refused.
    pub fn refused(line: usize, id: Option<String>, problem: ProblemView) -> Self {
        Self { id, line, status: problem.status, problem: Some(problem), ..Self::default() }
    }
}

/// Returns the id that a line gives itself, if it can be read, for naming it in the answer.
pub fn line_id(line: Json<'_>) -> Option<String> {
    let id: KeyframeId = line.get("id")?.as_str()?.parse().ok()?;
    Some(id.to_string())
}

/// Returns a line: an id and the members of a keyframe.
pub fn decode(line: Json<'_>) -> Result<SentKeyframe, Faulty> {
    of_line(line).map_err(|faults| Faulty::of(faults, Some(line)))
}
