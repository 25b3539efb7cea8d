//! Anchors: search, read, describe by hand, put as a plan shows them, delete.

use super::views;
use crate::domain::ids::{AnchorSeq, MapId, PriorId};
use crate::domain::invalid::FieldError;
use crate::domain::keyframe::Crop;
use crate::domain::prior::{AnchorKey, NewPrior, id_form, is_servers_form};
use crate::domain::report::{AnchorReport, Page};
use crate::domain::request::{AnchorFilter, PageRequest};
use crate::engine::error::refuse;
use crate::engine::limits::quota::check_prior;
use crate::engine::maps::live::Decision;
use crate::engine::maps::write_path::Manner;
use crate::engine::{Result, Service, ServiceError, Stored};
use crate::recognition::anchors::describing::describe;
use crate::recognition::anchors::prior_anchors::{MAX_PRIORS, add_prior, prior_as_sent, prior_faults};
use crate::recognition::map::culling::delete_object;
use crate::recognition::map::index::{MapIndex, MergedAnchor};
use crate::recognition::plans::alignments::Alignments;
use crate::semantics::{self, Text, TextKind};

impl Service {
    /// Returns the anchors that pass a filter, oldest first.
    pub async fn list_anchors(
        &self,
        map: &MapId,
        filter: AnchorFilter,
        page: PageRequest,
    ) -> Result<(u64, Page<AnchorReport>)> {
        let live = self.live(map).await?;
        let from = match &page.cursor {
            Some(cursor) => AnchorSeq::from_public(cursor).ok_or_else(|| ServiceError::bad_cursor(cursor))?,
            None => AnchorSeq(0),
        };
        self.read(&live, move |state| {
            let index = &state.index;
            let text = filter.text.as_deref().map(Text::parse);
            let mut wanted =
                index.anchors_from(from).filter(|seq| passes(index, *seq, &filter, text.as_ref()));
            let mut alignments = Alignments::of(index);
            let report = |seq| views::anchor(index, seq, &mut alignments);
            let items = wanted.by_ref().take(page.limit).filter_map(report).collect();
            Ok(Page { items, next_cursor: wanted.next().map(AnchorSeq::public) })
        })
        .await
    }

    /// Returns an anchor as it stands.
    pub async fn get_anchor(&self, map: &MapId, key: AnchorKey) -> Result<(u64, AnchorReport)> {
        let live = self.live(map).await?;
        self.read(&live, move |state| find(&state.index, resolve(&state.index, &key)?)).await
    }

    /// Sets an anchor's description by hand, or gives it back to its readings; `expected` is the
    /// version the operator looked at.
    pub async fn describe_anchor(
        &self,
        map: &MapId,
        key: AnchorKey,
        expected: Option<u64>,
        description: Option<String>,
    ) -> Result<(u64, AnchorReport)> {
        let live = self.live(map).await?;
        let decide = move |index: &mut MapIndex| {
            let anchor = resolve(index, &key)?;
            check_version(index, anchor, expected)?;
            if let AnchorKey::Prior(id) = &key {
                return Err(described_by_plan(id));
            }
            let decided = describe(index, anchor, description.map(Into::into));
            let newest = index.anchor(anchor).and_then(|anchor| anchor.keyframes().max());
            // It may have become one with an older anchor.
            let anchor = index.objects().root(anchor).unwrap_or(anchor);
            Ok(Decision::Changed((find(index, anchor)?, newest), decided, None))
        };
        let ((report, newest), version) = self.change(&live, decide).await?;
        if let Some(keyframe) = newest {
            self.look_for_twins(&live, keyframe).await;
        }
        Ok((version, report))
    }

    /// Deletes an anchor with all that was merged into it.
    pub async fn delete_anchor(&self, map: &MapId, key: AnchorKey, expected: Option<u64>) -> Result<u64> {
        let live = self.live(map).await?;
        let decide = move |index: &mut MapIndex| {
            let anchor = resolve(index, &key)?;
            check_version(index, anchor, expected)?;
            Ok(Decision::Changed((), delete_object(index, anchor), None))
        };
        Ok(self.begin(&live, Manner::Freeing, decide).await?.committed().await?.1)
    }

    /// Puts a prior anchor, or finds that this very request had done so.
    pub async fn put_prior(&self, map: &MapId, new: NewPrior) -> Result<(u64, Stored<AnchorReport>)> {
        check_prior_id(&new)?;
        let live = self.live(map).await?;
        let room = self.room(live.owner).await?;
        let decide = move |index: &mut MapIndex| {
            if let Some(seq) = index.priors().by_id(&new.id) {
                if prior_as_sent(index, seq).as_ref() != Some(&new) {
                    return Err(prior_exists(&new));
                }
                return Ok(Decision::Unchanged((false, find(index, seq)?)));
            }
            refuse(prior_faults(index, &new))?;
            if index.priors().len() >= MAX_PRIORS {
                return Err(ServiceError::MapFull(format!(
                    "the map holds {MAX_PRIORS} prior anchors, and may hold no more"
                )));
            }
            check_prior(&room, index, &new)?;
            let (seq, decided) = add_prior(index, &new);
            Ok(Decision::Changed((true, find(index, seq)?), decided, None))
        };
        let ((created, value), version) = self.change(&live, decide).await?;
        Ok((version, Stored { created, value }))
    }

    /// Returns the best image crop of an anchor.
    pub async fn crop(&self, map: &MapId, key: AnchorKey) -> Result<Crop> {
        let live = self.live(map).await?;
        let asked = key.clone();
        let (_, best) = self
            .read(&live, move |state| Ok(views::best_crop(&state.index, object_of(&state.index, &asked)?)))
            .await?;
        let none = || ServiceError::NotFound(format!("anchor {key} has no crop"));
        let (keyframe, detection) = best.ok_or_else(none)?;
        self.store.crop(live.key, keyframe, detection).await?.ok_or_else(none)
    }
}

/// Returns the anchor that a public id names. A prior anchor has its name alone, and no number beside it.
fn resolve(index: &MapIndex, key: &AnchorKey) -> Result<AnchorSeq> {
    let found = match key {
        AnchorKey::Numbered(seq) => index.anchor(*seq).filter(|anchor| anchor.prior.is_none()).map(|_| *seq),
        AnchorKey::Prior(id) => index.priors().by_id(id),
    };
    found.ok_or_else(|| ServiceError::no_anchor(key))
}

/// Returns what an anchor is with all that was merged into it.
pub(super) fn object_of<'i>(index: &'i MapIndex, key: &AnchorKey) -> Result<&'i MergedAnchor> {
    let root = index.objects().root(resolve(index, key)?);
    root.and_then(|root| index.objects().get(root)).ok_or_else(|| ServiceError::no_anchor(key))
}

fn described_by_plan(id: &PriorId) -> ServiceError {
    let detail =
        format!("anchor {id} is described by its plan; delete it, and put it with what the sign says now");
    ServiceError::Conflict { code: "prior_anchor", detail }
}

fn find(index: &MapIndex, anchor: AnchorSeq) -> Result<AnchorReport> {
    let report = views::anchor(index, anchor, &mut Alignments::of(index));
    report.ok_or_else(|| ServiceError::no_anchor(anchor.public()))
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

/// Rejects a name that the server may give to an anchor of its own.
fn check_prior_id(new: &NewPrior) -> Result<()> {
    if !is_servers_form(new.id.as_str()) {
        return Ok(());
    }
    let fault = FieldError::new("{anchor}", "the server names anchors so itself");
    Err(fault.got(&new.id).limit(id_form()).into())
}

fn prior_exists(new: &NewPrior) -> ServiceError {
    let detail = format!(
        "prior anchor {} exists and was sent with another body; delete it first if the plan has changed",
        new.id
    );
    ServiceError::Conflict { code: "prior_exists", detail }
}
