//! The alignments of a map's sessions, each computed once where a reader asks for it.

use std::collections::BTreeMap;

use super::plan_alignment::{PlanAlignment, plan_alignment};
use crate::domain::ids::{AnchorSeq, SessionSeq};
use crate::geometry::Point3;
use crate::recognition::map::index::{MapIndex, MergedAnchor};
use crate::semantics::Text;

/// The alignments of the sessions of a map, at one version.
#[derive(Debug)]
pub struct Alignments<'a> {
    index: &'a MapIndex,
    known: BTreeMap<SessionSeq, Option<PlanAlignment>>,
}

impl<'a> Alignments<'a> {
    /// Begins with none.
    pub fn of(index: &'a MapIndex) -> Self {
        Self { index, known: BTreeMap::new() }
    }

    /// Returns the alignment of a session, if it is aligned.
    pub fn session(&mut self, session: SessionSeq) -> Option<PlanAlignment> {
        *self.known.entry(session).or_insert_with(|| plan_alignment(self.index, session))
    }

    /// Returns the place of an object in a plan's frame: of a prior one as the plan has it, else by the oldest of the aligned
    /// sessions that saw it, which is returned with it.
    pub fn place(&mut self, object: &MergedAnchor) -> Option<(SessionSeq, Option<SessionSeq>, Point3)> {
        let prior = object.members.first().and_then(|first| self.index.anchor(*first)?.prior.as_ref());
        if let Some(prior) = prior {
            return Some((prior.frame, None, prior.position_in_frame));
        }
        object.shapes.iter().find_map(|(session, shape)| {
            let centre = shape.aabb?.centre();
            let alignment = self.session(*session)?;
            Some((alignment.frame, Some(*session), alignment.plan_from_session.transform(&centre)))
        })
    }
}

/// Returns the prior anchors that match a text, whatever saw it: their places stand for the sign's.
pub fn matching_priors(index: &MapIndex, class: &str, text: &Text) -> Vec<AnchorSeq> {
    if index.priors().is_empty() {
        return Vec::new();
    }
    let carriers =
        index.texts().matching_text(class, text).into_iter().flat_map(|text| index.texts().objects(text));
    carriers.filter(|anchor| index.anchor(*anchor).is_some_and(|anchor| anchor.prior.is_some())).collect()
}
