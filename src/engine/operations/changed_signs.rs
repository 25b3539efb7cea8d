//! Signs that change are judged inside the write of the keyframe that leaves them behind, so that a map's version says which
//! of them are retired.

use tokio::runtime::Handle;

use crate::domain::ids::KeyframeSeq;
use crate::engine::maps::live::LiveMap;
use crate::engine::{Result, Service};
use crate::geometry::Point3;
use crate::recognition::extensions::changed_signs::{
    LOOKS_OF_A_WRITE_MAX, Look, Passage, looks, may_have_missed, missed, passages_ended_by, seen_again,
    tracked_here,
};
use crate::recognition::map::index::MapIndex;
use crate::recognition::map::recorder::Decided;

impl Service {
    /// Judges the signs of which a keyframe ends a passage, and adds what follows to the write that is being decided. Blocks,
    /// as a decision may: not for async threads.
    pub(in crate::engine) fn add_changed_signs(
        &self,
        live: &LiveMap,
        index: &mut MapIndex,
        arrived: KeyframeSeq,
        decided: &mut Decided,
    ) {
        if !index.properties().settings.signs_may_change {
            return;
        }
        let mut looks_left = LOOKS_OF_A_WRITE_MAX;
        for passage in passages_ended_by(index, arrived) {
            let judged = match seen_again(index, &passage) {
                Some(judged) => Some(judged),
                None if !may_have_missed(index, &passage) => None,
                None => match self.place_of(live, index, &passage, &mut looks_left) {
                    Ok(place) => place.map(|place| missed(index, &passage, &place)),
                    // The write is decided already, and does not depend on it.
                    Err(error) => {
                        tracing::warn!(%error, "a sign that was not seen could not be judged");
                        None
                    }
                },
            };
            let judged = judged.unwrap_or_default();
            decided.changes.extend(judged.changes);
            decided.events.extend(judged.events);
        }
    }

    /// Returns where a sign would hang as the passage has it, if the passage was there.
    fn place_of(
        &self,
        live: &LiveMap,
        index: &MapIndex,
        passage: &Passage,
        looks_left: &mut usize,
    ) -> Result<Option<Point3>> {
        if tracked_here(index, passage) {
            return Ok(Some(passage.sign.centre));
        }
        for look in looks(index, passage, *looks_left) {
            *looks_left -= 1;
            let found = Handle::current().block_on(self.look_at(live, index, passage, &look))?;
            if found.is_some() {
                return Ok(found);
            }
        }
        Ok(None)
    }

    async fn look_at(
        &self,
        live: &LiveMap,
        index: &MapIndex,
        passage: &Passage,
        look: &Look,
    ) -> Result<Option<Point3>> {
        // Whatever was decided before has features to be read; the writer needs no lock of the map.
        live.on_disk(&self.store, live.newest_version()).await?;
        let features = self.features.read(&self.store, live.key, look.wanted_features()).await?;
        Ok(look.verify(index, passage, &features))
    }
}
