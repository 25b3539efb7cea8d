//! Signs that change are judged after the write of the keyframe that leaves them behind, in a version of the map of its own.

use std::sync::Arc;

use crate::engine::maps::live::{Decision, LiveMap};
use crate::engine::{Result, Service};
use crate::geometry::Point3;
use crate::recognition::extensions::changed_signs::{Look, Passage, judge, looks};
use crate::recognition::map::index::MapIndex;

impl Service {
    /// Judges the signs of passages that have ended.
    pub(super) async fn judge_signs(&self, live: &Arc<LiveMap>, passages: Vec<Passage>) -> Result<()> {
        let passages = Arc::new(passages);
        let ended = passages.clone();
        let (_, looks) = self.look(live, move |state| Ok(looks(&state.index, &ended))).await?;
        let mut places = Vec::new();
        for of_passage in looks {
            places.push(self.place_of(live, of_passage).await?);
        }
        let decide = move |index: &mut MapIndex| Ok(Decision::of((), judge(index, &passages, &places)));
        self.change(live, decide).await.map(drop)
    }

    /// Returns where a sign would hang as one of these keyframes has it.
    async fn place_of(&self, live: &LiveMap, looks: Vec<Look>) -> Result<Option<Point3>> {
        for look in looks {
            let features = self.features.read(&self.store, live.key, look.wanted_features()).await?;
            let found = self.verify(Some(live.key), move || look.verify(&features)).await?;
            if found.is_some() {
                return Ok(found);
            }
        }
        Ok(None)
    }
}
