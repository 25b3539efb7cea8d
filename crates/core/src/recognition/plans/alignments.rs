//! The alignments of a map's sessions, each computed once where a reader asks for it.

use std::collections::BTreeMap;

use super::plan_alignment::{PlanAlignment, plan_alignment};
use super::plan_texts::PlanTexts;
use crate::domain::ids::{AnchorSeq, SessionSeq};
use crate::geometry::Point3;
use crate::recognition::map::index::{MapIndex, MergedAnchor};
use crate::semantics::Text;

/// The alignments of the sessions of a map, at one version.
#[derive(Debug)]
pub struct Alignments<'a> {
    index: &'a MapIndex,
    /// Collected when the first session is aligned.
    texts: Option<PlanTexts>,
    known: BTreeMap<SessionSeq, Option<PlanAlignment>>,
}

impl<'a> Alignments<'a> {
    /// Begins with none.
    pub fn of(index: &'a MapIndex) -> Self {
        Self { index, texts: None, known: BTreeMap::new() }
    }

    /// Returns the alignment of a session, if it is aligned.
    pub fn session(&mut self, session: SessionSeq) -> Option<PlanAlignment> {
        let (index, texts) = (self.index, &mut self.texts);
        let align = || plan_alignment(index, texts.get_or_insert_with(|| PlanTexts::of(index)), session);
        *self.known.entry(session).or_insert_with(align)
    }

    /// Returns the prior anchors that a text names, whatever read it: their places in the plans stand for the sign's.
    pub fn priors_of(&mut self, class: &str, text: &Text) -> Vec<AnchorSeq> {
        let index = self.index;
        self.texts.get_or_insert_with(|| PlanTexts::of(index)).same(index, class, text)
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
