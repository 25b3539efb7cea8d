//! Values of the model as JSON, in columns that hold what is read as a whole.

use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::StoreError;

/// Returns a value as text.
pub(crate) fn text(value: &impl Serialize) -> Result<String, StoreError> {
    serde_json::to_string(value).map_err(|error| StoreError::Database(error.to_string()))
}

/// Returns the value of a text.
pub(crate) fn value<T: DeserializeOwned>(text: &str) -> Result<T, StoreError> {
    serde_json::from_str(text).map_err(|error| StoreError::corrupt(error.to_string()))
}
