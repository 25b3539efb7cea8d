//! What a reader is shown of an anchor.

use crate::domain::anchor::AnchorState;
use crate::domain::ids::{AnchorSeq, SessionId, SessionSeq};
use crate::domain::prior::Prior;
use crate::domain::report::{AnchorMatchReport, AnchorReport, PlanPlace};
use crate::recognition::anchors::matching;
use crate::recognition::map::index::{Description, MapIndex, MergedAnchor};
use crate::recognition::plans::alignments::Alignments;
use crate::semantics::{self, Source};

/// Maximum matching anchors that an anchor shows; an EXIT sign has thousands.
const MATCHES_SHOWN: usize = 100;

/// Returns an anchor as it stands, beside others whose sessions are aligned once; of a merged one, what is its own. `None` if there is
/// no such anchor.
pub(in crate::engine) fn anchor(
    index: &MapIndex,
    seq: AnchorSeq,
    alignments: &mut Alignments<'_>,
) -> Option<AnchorReport> {
    let root = index.objects().root(seq)?;
    let alone = if root == seq { None } else { Some(index.anchor_alone(seq)?) };
    let object = alone.as_ref().or_else(|| index.objects().get(root))?;
    let description = object.description.as_ref();
    let numbering = index.readings().numbering(index.class_of(object));
    let named = |keyframe| index.keyframe(keyframe).map(|keyframe| keyframe.id.clone());
    let (matches, matches_total) = if root == seq { matches(index, root, object) } else { (Vec::new(), 0) };
    Some(AnchorReport {
        anchor: seq,
        name: index.anchor_name(seq),
        prior: prior(index, seq),
        class: index.class_of(object).to_owned(),
        state: object.state,
        description: description.map(|description| description.raw.to_string()),
        kind: description.map(|description| description.kind),
        description_source: match description {
            Some(description) if description.by_hand => "operator",
            _ if index.anchor(seq)?.prior.is_some() => "plan",
            _ => "readings",
        },
        identifiers: description
            .map(|d| d.text.names().map(|name| name.as_str().to_owned()).collect())
            .unwrap_or_default(),
        information_level: description.map_or(1, |description| description.information_level),
        information_reason: description.map(|description| information_reason(index, object, description)),
        numbering: (numbering.into_iter())
            .flat_map(|numbering| numbering.learned_or_given().map(str::to_owned))
            .collect(),
        plan_place: plan_place(index, object, alignments),
        readings: object.votes.report(),
        disagreement: object.votes.disagreement(numbering),
        keyframes: index.keyframes_of(object).into_iter().filter_map(named).collect(),
        frames: object
            .shapes
            .iter()
            .filter_map(|(session, shape)| {
                Some((index.sessions()[session.index()].clone(), shape.aabb?, shape.range_assumed))
            })
            .collect(),
        map_points: object.shapes.values().map(|shape| shape.map_points.len()).sum(),
        matches,
        matches_total,
        replaced_by: index.replacement_of(object).filter(|_| object.state == AnchorState::Retired),
        merged_into: (root != seq).then_some(root),
        merged_from: object.members.iter().copied().filter(|member| *member != seq).collect(),
        version: index.anchor(seq)?.version,
        has_crop: best_crop(index, object).is_some(),
    })
}

/// Returns what a plan says of an anchor, and the session that stands for the plan's frame.
fn prior(index: &MapIndex, seq: AnchorSeq) -> Option<(SessionId, Prior)> {
    let prior = index.anchor(seq)?.prior.as_deref()?;
    Some((index.sessions().get(prior.frame.index())?.clone(), prior.clone()))
}

/// Returns the place of an anchor in a plan's frame, by names.
fn plan_place(index: &MapIndex, object: &MergedAnchor, alignments: &mut Alignments<'_>) -> Option<PlanPlace> {
    let (frame, by, position_in_frame) = alignments.place(object)?;
    let named = |session: SessionSeq| index.sessions().get(session.index()).cloned();
    Some(PlanPlace { frame: named(frame)?, by: by.and_then(named), position_in_frame })
}

/// Why a description has its InformationLevel.
fn information_reason(index: &MapIndex, object: &MergedAnchor, description: &Description) -> String {
    let (level, reason) = semantics::information(&description.text);
    let by_model = index.verdicts().information(index.class_of(object), &description.text);
    match () {
        () if description.information_level == level => reason,
        () if by_model == Some(description.information_level) => "a model judged so".to_owned(),
        () => "it was read once, by a reader that was not confident, and never alike again".to_owned(),
    }
}

fn matches(index: &MapIndex, root: AnchorSeq, object: &MergedAnchor) -> (Vec<AnchorMatchReport>, usize) {
    let texts = index.texts();
    let Some(text) = texts.of(root) else { return (Vec::new(), 0) };
    let total = matching::matches(index, root).count();
    let near = if total == 0 { Vec::new() } else { matching::neighbourhood(index, root) };
    let shown = matching::matches(index, root).take(MATCHES_SHOWN).filter_map(|other| {
        let (level, source) = texts.level(text, texts.of(other)?)?;
        let (ours, theirs) =
            (object.description.as_ref()?, index.objects().get(other)?.description.as_ref()?);
        Some(AnchorMatchReport {
            anchor: other,
            name: index.anchor_name(other),
            level,
            source: source.as_str().to_owned(),
            revisit: near.binary_search(&other).is_err(),
            reason: match &source {
                // The built-in judge's reason would be of another level, by another judge.
                Source::Model(model) => {
                    let class = index.class_of(object);
                    let reason = index.verdicts().reason(class, &ours.text, &theirs.text);
                    reason.map_or_else(|| format!("{model} judged so, without a reason"), str::to_owned)
                }
                _ => semantics::similarity(&ours.text, &theirs.text).reason,
            },
        })
    });
    let mut shown: Vec<AnchorMatchReport> = shown.collect();
    shown.sort_by_key(|report| report.anchor);
    (shown, total)
}

/// Returns the keyframe and the detection with the largest crop of an object; of equals, the newest.
pub(in crate::engine) fn best_crop(
    index: &MapIndex,
    object: &MergedAnchor,
) -> Option<(crate::domain::ids::KeyframeSeq, u16)> {
    let observations = object
        .members
        .iter()
        .filter_map(|member| index.anchor(*member))
        .flat_map(|a| a.observations.values());
    observations
        .filter_map(|observation| {
            Some((observation.crop_area_px?, observation.keyframe, observation.detection))
        })
        .max_by(|a, b| a.0.total_cmp(&b.0).then_with(|| (a.1, a.2).cmp(&(b.1, b.2))))
        .map(|(_, keyframe, detection)| (keyframe, detection))
}
