//! Anchors: search, read, describe by hand, delete.

use super::views;
use crate::domain::ids::{AnchorSeq, MapId, PriorId};
use crate::domain::keyframe::Crop;
use crate::domain::prior::AnchorKey;
use crate::domain::report::{AnchorReport, Page};
use crate::domain::request::AnchorFilter;
use crate::engine::maps::live::Decision;
use crate::engine::maps::write_path::Manner;
use crate::engine::{Result, Service, ServiceError};
use crate::recognition::anchors::describing::describe;
use crate::recognition::map::culling::delete_object;
use crate::recognition::map::index::MapIndex;
use crate::recognition::plans::alignments::Alignments;
use crate::semantics::{self, Text, TextKind};

impl Service {
    /// Returns the anchors that pass a filter, oldest first.
    pub async fn list_anchors(
        &self,
        map: &MapId,
        filter: AnchorFilter,
        cursor: Option<&str>,
        limit: usize,
    ) -> Result<(u64, Page<AnchorReport>)> {
        let live = self.live(map).await?;
        let from = match cursor {
            Some(cursor) => AnchorSeq::from_public(cursor).ok_or_else(|| ServiceError::bad_cursor(cursor))?,
            None => AnchorSeq(0),
        };
        self.read(&live, move |state| {
            let index = &state.index;
            let text = filter.text.as_deref().map(Text::parse);
            let mut wanted =
                index.anchors_from(from).filter(|seq| passes(index, *seq, &filter, text.as_ref()));
            let mut alignments = Alignments::of(index);
            let report = |seq| views::anchor_with(index, seq, &mut alignments);
            let items = wanted.by_ref().take(limit).filter_map(report).collect();
            Ok(Page { items, next_cursor: wanted.next().map(AnchorSeq::public) })
        })
        .await
    }

    /// Returns an anchor as it stands.
    pub async fn get_anchor(&self, map: &MapId, anchor: impl Into<AnchorKey>) -> Result<(u64, AnchorReport)> {
        let live = self.live(map).await?;
        let key = anchor.into();
        self.read(&live, move |state| find(&state.index, resolve(&state.index, &key)?)).await
    }

    /// Sets an anchor's description by hand, or gives it back to its readings; `expected` is the
    /// version the operator looked at.
    pub async fn describe_anchor(
        &self,
        map: &MapId,
        anchor: impl Into<AnchorKey>,
        expected: Option<u64>,
        description: Option<String>,
    ) -> Result<(u64, AnchorReport)> {
        let live = self.live(map).await?;
        let key = anchor.into();
        let (service, of_map) = (self.clone(), live.clone());
        let decide = move |index: &mut MapIndex| {
            let anchor = resolve(index, &key)?;
            check_version(index, anchor, expected)?;
            if let AnchorKey::Prior(id) = &key {
                return Err(described_by_plan(id));
            }
            let mut decided = describe(index, anchor, description.map(Into::into));
            let newest = index.anchor(anchor).and_then(|anchor| anchor.keyframes().max());
            if let Some(keyframe) = newest {
                service.add_twins(&of_map, index, (keyframe, None), &mut decided);
            }
            // It may have become one with an older anchor.
            let anchor = index.objects().root(anchor).unwrap_or(anchor);
            Ok(Decision::Changed(find(index, anchor)?, decided, None))
        };
        let (report, version) = self.change(&live, decide).await?;
        Ok((version, report))
    }

    /// Deletes an anchor with all that was merged into it.
    pub async fn delete_anchor(
        &self,
        map: &MapId,
        anchor: impl Into<AnchorKey>,
        expected: Option<u64>,
    ) -> Result<u64> {
        let live = self.live(map).await?;
        let key = anchor.into();
        let decide = move |index: &mut MapIndex| {
            let anchor = resolve(index, &key)?;
            check_version(index, anchor, expected)?;
            Ok(Decision::Changed((), delete_object(index, anchor), None))
        };
        Ok(self.begin(&live, Manner::Freeing, decide).await?.committed().await?.1)
    }

    /// Returns the best image crop of an anchor.
    pub async fn crop(&self, map: &MapId, anchor: impl Into<AnchorKey>) -> Result<Crop> {
        let live = self.live(map).await?;
        let key = anchor.into();
        let asked = key.clone();
        let (_, best) = self
            .read(&live, move |state| {
                let root = state.index.objects().root(resolve(&state.index, &asked)?);
                let object = root.and_then(|root| state.index.objects().get(root));
                let object = object.ok_or_else(|| ServiceError::no_anchor(&asked))?;
                Ok(views::best_crop(&state.index, object))
            })
            .await?;
        let none = || ServiceError::NotFound(format!("anchor {key} has no crop"));
        let (keyframe, detection) = best.ok_or_else(none)?;
        self.store.crop(live.key, keyframe, detection).await?.ok_or_else(none)
    }
}

/// Returns the anchor that a public id names. A prior anchor has its name alone, and no number beside it.
pub(super) fn resolve(index: &MapIndex, key: &AnchorKey) -> Result<AnchorSeq> {
    let found = match key {
        AnchorKey::Numbered(seq) => index.anchor(*seq).filter(|anchor| anchor.prior.is_none()).map(|_| *seq),
        AnchorKey::Prior(id) => index.priors().by_id(id),
    };
    found.ok_or_else(|| ServiceError::no_anchor(key))
}

fn described_by_plan(id: &PriorId) -> ServiceError {
    let detail =
        format!("anchor {id} is described by its plan; delete it, and put it with what the sign says now");
    ServiceError::Conflict { code: "prior_anchor", detail }
}

fn find(index: &MapIndex, anchor: AnchorSeq) -> Result<AnchorReport> {
    views::anchor(index, anchor).ok_or_else(|| ServiceError::no_anchor(anchor.public()))
}

fn passes(index: &MapIndex, seq: AnchorSeq, filter: &AnchorFilter, text: Option<&Text>) -> bool {
    let Some(anchor) = index.anchor(seq) else { return false };
    if filter.class.as_deref().is_some_and(|class| *class != *anchor.class) {
        return false;
    }
    if filter.prior.is_some_and(|prior| prior != anchor.prior.is_some()) {
        return false;
    }
    let is_root = index.objects().root(seq) == Some(seq);
    if !is_root && !filter.merged {
        return false;
    }
    if text.is_none() && filter.state.is_none() {
        return true;
    }
    let alone = if is_root { None } else { index.anchor_alone(seq) };
    let Some(object) = alone.as_ref().or_else(|| index.objects().get(seq)) else { return false };
    // A part of the text, or of a name in any of its spellings.
    let contains = |sought: &Text| {
        object.description.as_ref().is_some_and(|description| {
            let text = &description.text;
            // The normal form of a code has its capitals, which a person need not know.
            let is_in_code = || {
                let [code, part] = [text, sought].map(|text| semantics::fold(text.normalised()));
                text.kind() == TextKind::Code && code.contains(&part)
            };
            text.normalised().contains(sought.normalised())
                || text.gist().contains(sought.gist())
                || is_in_code()
        })
    };
    filter.state.is_none_or(|state| state == object.state) && text.is_none_or(contains)
}

fn check_version(index: &MapIndex, anchor: AnchorSeq, expected: Option<u64>) -> Result<()> {
    let Some(stored) = index.anchor(anchor) else { return Err(ServiceError::no_anchor(anchor.public())) };
    let root = index.objects().root(anchor).unwrap_or(anchor);
    if root != anchor {
        let detail =
            format!("anchor {} was merged into {}; address that one", anchor.public(), root.public());
        return Err(ServiceError::Conflict { code: "anchor_merged", detail });
    }
    match expected {
        Some(expected) if expected != stored.version => Err(ServiceError::PreconditionFailed(format!(
            "the anchor has version {}, not {expected}; read it again",
            stored.version
        ))),
        _ => Ok(()),
    }
}
