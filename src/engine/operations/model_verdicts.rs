//! Model verdicts that a client brings: applied as if a model had answered here.

use super::named::no_keyframe_of_map;
use crate::domain::ids::MapId;
use crate::domain::judged::CropRead;
use crate::domain::request::NewVerdict;
use crate::engine::{Result, Service};
use crate::recognition::anchors::apply_model_answer::learn_verdict;
use crate::recognition::map::index::MapIndex;

impl Service {
    /// Applies what a model said elsewhere. Returns the map's version, and whether it changed anything.
    pub async fn bring_verdict(&self, map: &MapId, new: NewVerdict) -> Result<(u64, bool)> {
        let live = self.live(map).await?;
        let (service, of_map) = (self.clone(), live.clone());
        let learn = move |index: &mut MapIndex| match new {
            NewVerdict::OfTexts(verdict) => Ok(learn_verdict(index, verdict)),
            crop @ NewVerdict::OfCrop(..) => {
                let read = crop_read(index, crop)?;
                Ok(read.and_then(|read| service.learn_crop(&of_map, index, read)))
            }
        };
        self.learn(&live, learn).await
    }
}

/// Returns the reading of a crop with the anchor that its detection feeds; `None` if it feeds none.
fn crop_read(index: &MapIndex, new: NewVerdict) -> Result<Option<CropRead>> {
    let NewVerdict::OfCrop(named, reading) = new else { return Ok(None) };
    let Some(keyframe) = index.keyframe_seq(&named.keyframe) else {
        return Err(no_keyframe_of_map("/keyframe", &named.keyframe).into());
    };
    let at = (keyframe, named.number);
    let feeds = |anchor: &crate::domain::ids::AnchorSeq| {
        index.anchor(*anchor).is_some_and(|anchor| anchor.observations.contains_key(&at))
    };
    let anchor = index.anchors_seen_by(keyframe).find(feeds);
    Ok(anchor.map(|anchor| CropRead {
        anchor,
        keyframe,
        detection: named.number,
        reading,
        transcript: Vec::new(),
        // No model of this server said it: a job that asks again asks for it, too.
        fingerprint: "".into(),
    }))
}
