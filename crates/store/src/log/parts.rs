//! Parts: the changes of a version that the log keeps, each part of a size that one slice brings into the rows.

use std::borrow::Cow;

use revisit_core::domain::change::Change;
use revisit_core::domain::former::FormerValues;
use revisit_core::domain::ids::{KeyframeSeq, PointId};
use revisit_core::domain::map::MapProperties;
use revisit_core::geometry::Sim3;

use super::entry::Entry;
use crate::sizes::sizes;

/// The purpose of a part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// Changes that were said, and the values that they replaced: part 0.
    Said,
    /// Findings of models that were replaced.
    Unsaid,
    /// Poses and points that were set, or values that were replaced. They stay.
    Moved,
    /// Anything else until it is in the rows.
    Passing,
}

impl Kind {
    pub(crate) fn as_str(self) -> &'static str {
        match self {
            Self::Said => "said",
            Self::Unsaid => "unsaid",
            Self::Moved => "moved",
            Self::Passing => "passing",
        }
    }
}

/// A part of a version.
#[derive(Clone, Debug, PartialEq)]
pub struct Part<'b> {
    pub(crate) kind: Kind,
    pub(crate) entry: Entry<'b>,
}

impl Part<'_> {
    /// Returns the part that sets a map's properties.
    pub(crate) fn setting(properties: &MapProperties) -> Self {
        let set = Cow::Owned(Change::MapSet(Box::new(properties.clone())));
        Self { kind: Kind::Said, entry: Entry { changes: vec![set], ..Entry::default() } }
    }

    /// Returns the number of values that it holds.
    pub(crate) fn len(&self) -> usize {
        self.entry.changes.len() + self.entry.former.len()
    }
}

/// Returns the kinds of changes that may wait, in the order in which those of one version reach the rows; none depends on another.
fn place(change: &Change) -> Option<usize> {
    match change {
        Change::PoseSet(..) => Some(0),
        Change::PointSet(..) => Some(1),
        Change::PointsForgotten(..) => Some(2),
        Change::AnchorTouched(..) => Some(3),
        _ => None,
    }
}

/// Whether a change may reach its row later.
pub(crate) fn can_wait(change: &Change) -> bool {
    place(change).is_some()
}

/// Whether a change must not overtake those that wait. Of an anchor's versions the largest counts, in whatever order they come.
pub(crate) fn is_ordered(change: &Change) -> bool {
    can_wait(change) && !matches!(change, Change::AnchorTouched(..))
}

/// Returns the parts of changes that reach their rows later. Where a map keeps its history, poses and points stay after that.
pub(crate) fn moved<'c>(
    changes: impl Iterator<Item = Cow<'c, Change>>,
    keeps_history: bool,
) -> Vec<Part<'c>> {
    let mut kinds: [Vec<Cow<'c, Change>>; 4] = Default::default();
    for change in changes {
        let Some(place) = place(&change) else { continue };
        match &*change {
            Change::PointsForgotten(session, points) if points.len() > sizes().part => {
                let some = |points: &[PointId]| Cow::Owned(Change::PointsForgotten(*session, points.into()));
                kinds[place].extend(points.chunks(sizes().part).map(some));
            }
            _ => kinds[place].push(change),
        }
    }
    let part = |changes: &[Cow<'c, Change>]| {
        let kind = match *changes[0] {
            Change::PoseSet(..) | Change::PointSet(..) if keeps_history => Kind::Moved,
            _ => Kind::Passing,
        };
        Part { kind, entry: Entry { changes: changes.to_vec(), ..Entry::default() } }
    };
    kinds.iter().flat_map(|of_kind| of_kind.chunks(sizes().part)).map(part).collect()
}

/// Returns the parts of the values that a large correction replaced.
pub(crate) fn replaced(former: FormerValues) -> Vec<Part<'static>> {
    let FormerValues { poses, points, forgotten } = former;
    let none = FormerValues::default;
    let poses = poses
        .chunks(sizes().part)
        .map(|some: &[(KeyframeSeq, Sim3)]| FormerValues { poses: some.to_vec(), ..none() });
    let points = points.chunks(sizes().part).map(|some| FormerValues { points: some.to_vec(), ..none() });
    let forgotten =
        forgotten.chunks(sizes().part).map(|some| FormerValues { forgotten: some.to_vec(), ..none() });
    let all = poses.chain(points).chain(forgotten);
    let part =
        |former| Part { kind: Kind::Moved, entry: Entry { former: Cow::Owned(former), ..Entry::default() } };
    all.map(part).collect()
}
