//! Model verdicts that a client brings: applied as if a model had answered here.

use super::named::no_keyframe_of_map;
use crate::domain::ids::MapId;
use crate::domain::judged::CropRead;
use crate::domain::request::NewVerdict;
use crate::engine::maps::live::Decision;
use crate::engine::{Result, Service};
use crate::recognition::anchors::apply_model_answer::{Learned, learn_reading, learn_verdict};
use crate::recognition::map::index::MapIndex;

impl Service {
    /// Applies what a model said elsewhere. Returns the map's version, and whether it changed anything.
    pub async fn bring_verdict(&self, map: &MapId, new: NewVerdict) -> Result<(u64, bool)> {
        let live = self.live(map).await?;
        let (service, of_map) = (self.clone(), live.clone());
        let decide = move |index: &mut MapIndex| {
            let learned = match new {
                NewVerdict::OfTexts(verdict) => learn_verdict(index, verdict),
                crop @ NewVerdict::OfCrop(..) => {
                    let Some(read) = crop_read(index, crop)? else { return Ok(Decision::Unchanged(None)) };
                    let keyframe = read.keyframe;
                    learn_reading(index, read).map(|mut learned| {
                        service.add_twins(&of_map, index, (keyframe, None), &mut learned.decided);
                        learned
                    })
                }
            };
            Ok(match learned {
                Some(Learned { decided, triggers }) => Decision::Changed(Some(triggers), decided, None),
                None => Decision::Unchanged(None),
            })
        };
        let (triggers, version) = self.change(&live, decide).await?;
        let applied = triggers.is_some();
        self.trigger(&live.id, triggers.unwrap_or_default());
        Ok((version, applied))
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
