//! The rule that the global descriptors of a map can all be compared: one model, one encoding, one size.

use super::{Result, ServiceError};
use crate::domain::global_descriptor::{GlobalDescriptor, GlobalForm};
use crate::recognition::map::index::MapIndex;

/// Refuses a global descriptor that cannot be compared with those of the map.
pub(super) fn check_global_descriptor(index: &MapIndex, descriptor: Option<&GlobalDescriptor>) -> Result<()> {
    let (Some(theirs), Some(ours)) = (descriptor, index.globals().form()) else { return Ok(()) };
    if theirs.is_of(ours) {
        return Ok(());
    }
    let detail = format!(
        "the global descriptors of this map are {}, that of the keyframe (/global_descriptor) is {}; they cannot be \
         compared. Use one model for a map, in one encoding and size",
        named(ours),
        named(&theirs.form())
    );
    Err(ServiceError::Conflict { code: "other_global_descriptor", detail })
}

fn named(form: &GlobalForm) -> String {
    let GlobalForm { model, encoding, bytes } = form;
    format!("of model {model}, {}, {bytes} bytes", encoding.as_str())
}
