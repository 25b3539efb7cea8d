//! Quota: does a keyframe fit into its map?

use super::ServiceError;
use crate::config::quotas::Quotas;
use crate::model::keyframe::NewKeyframe;
use crate::recognition::index::MapIndex;

/// Refuses a keyframe that would take its map beyond a quota.
pub(super) fn check_quota(
    quotas: &Quotas,
    index: &MapIndex,
    keyframe: &NewKeyframe,
) -> Result<(), ServiceError> {
    let full = |what: &str, holds: u64, most: u64| ServiceError::MapFull {
        detail: format!(
            "the map holds {holds} {what}, and may hold {most}; delete some, or ask the operator"
        ),
    };
    let over = |quota: Option<u64>, after: u64| quota.filter(|most| after > *most);
    let keyframes = index.keyframe_count() as u64;
    if let Some(most) = over(quotas.map_max_keyframes, keyframes + 1) {
        return Err(full("keyframes", keyframes, most));
    }
    let anchors = index.objects().len() as u64;
    let adds_anchors = u64::from(!keyframe.detections.is_empty());
    if let Some(most) = over(quotas.map_max_anchors, anchors + adds_anchors).filter(|_| adds_anchors > 0) {
        return Err(full("anchors", anchors, most));
    }
    if let Some(most) = over(quotas.map_max_bytes, index.bytes() + keyframe.bytes()) {
        return Err(full("bytes", index.bytes(), most));
    }
    Ok(())
}
