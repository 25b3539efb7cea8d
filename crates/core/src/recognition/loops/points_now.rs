//! Map points of a keyframe since it was sent: others by now, or gone (M57).

use std::sync::Arc;

use crate::domain::change::{Keyframe, Renamed};
use crate::domain::ids::PointId;

/// The present map points of those that a keyframe's features were sent with, at one version of its map.
#[derive(Clone, Debug)]
pub struct PointsNow {
    renamed: Renamed,
    observes: Box<[PointId]>,
}

impl PointsNow {
    /// Returns what became of a keyframe's map points; `None` if nothing did.
    pub fn of(keyframe: &Keyframe) -> Option<Arc<Self>> {
        let renamed = keyframe.renamed.clone()?;
        Some(Arc::new(Self { renamed, observes: keyframe.observes.iter().collect() }))
    }

    /// Returns the map point that a feature observes which was sent with this one, if it observes one still.
    pub fn now(&self, sent: PointId) -> Option<PointId> {
        let Renamed { pairs, is_complete } = &self.renamed;
        let now = match pairs.binary_search_by_key(&sent, |(sent, _)| *sent) {
            Ok(at) => pairs[at].1,
            Err(_) if *is_complete => return None,
            Err(_) => sent,
        };
        self.observes.binary_search(&now).is_ok().then_some(now)
    }
}
