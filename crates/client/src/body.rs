//! Body: the body of a request, in the shape that its operation takes or as it was recorded.

use serde::Serialize;
use serde_json::{Map, Value};
use utoipa::ToSchema;

/// A body for an operation that takes `Shape`.
pub trait Body<Shape>: Serialize {}

/// A body as it was recorded: it is sent as it is, and the server says what is wrong with it.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[serde(transparent)]
pub struct Recorded(pub Map<String, Value>);

impl<Shape> Body<Shape> for Recorded {}

impl<Shape: Serialize + ToSchema> Body<Shape> for Shape {}
