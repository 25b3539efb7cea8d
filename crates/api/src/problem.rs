//! Problem: the one shape of every answer of 400 and above (RFC 9457, `openapi/openapi.yaml`).

use revisit_core::domain::invalid::FieldError;
use revisit_shapes::answer;

/// The reason why a request was refused, or failed.
#[answer]
#[derive(Default)]
#[schema(as = Problem)]
pub struct ProblemView {
    /// Address of an explanation of the kind of problem.
    #[serde(rename = "type")]
    pub kind: String,
    /// The kind of problem in a few words.
    pub title: String,
    /// The HTTP status.
    #[schema(minimum = 400, maximum = 599)]
    pub status: u16,
    /// Description of this occurrence.
    pub detail: String,
    /// The kind of problem, for programs.
    pub code: String,
    /// The request's id, as in the header `x-request-id` and in the server's log.
    pub request_id: String,
    /// Every fault of the request at once; empty where the request itself is not at fault.
    pub errors: Vec<FaultView>,
}

/// One fault of a request.
#[answer(of = FieldError)]
#[derive(Default)]
#[schema(as = Fault)]
pub struct FaultView {
    /// JSON pointer into the body (`/detections/0/box`), a query parameter (`?limit`), a part of the path (`{map}`)
    /// or a header (`if-match:`).
    pub pointer: String,
    /// Description of the fault.
    pub detail: String,
    /// The value that was sent, shortened.
    pub got: Option<String>,
    /// The values that are allowed.
    pub limit: Option<String>,
}
