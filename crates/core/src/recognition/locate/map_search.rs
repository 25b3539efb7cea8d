//! The search of one map: candidates of every channel with checks 2 and 3 of §V, and poses from anchors.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::Vector3;

use super::anchor_pose::{AnchorPose, Verticals, anchor_poses};
use super::sighted_anchor::{SightedAnchor, pairs_by_session, sighted_anchors};
use super::sites::{Site, Sites};
use crate::domain::bow::Score;
use crate::domain::channel::Channel;
use crate::domain::ids::{AnchorSeq, KeyframeId, KeyframeSeq, SessionId, SessionSeq};
use crate::domain::keyframe::NewKeyframe;
use crate::domain::location::{AskedKeyframe, SignEvidence};
use crate::domain::roles::Roles;
use crate::domain::verdict::{AnchorName, Candidate, Verify};
use crate::geometry::{Point3, Pose};
use crate::recognition::extensions::distinctiveness::PlaceCounts;
use crate::recognition::loops::anchor_check::{AnchorCheck, Counts};
use crate::recognition::loops::candidates::{Proposals, find_candidates};
use crate::recognition::loops::fusion::fuse;
use crate::recognition::loops::geometry_snapshot::GeometrySnapshot;
use crate::recognition::loops::query::Query;
use crate::recognition::loops::screening::{PreVerified, Screening, Stage};
use crate::recognition::map::index::MapIndex;
use crate::recognition::plans::alignments::Alignments;

/// Candidates of one keyframe in one map that are compared: more than geometry looks at in all.
pub(in crate::recognition) const CANDIDATES_PER_MAP_MAX: usize = 24;

/// The camera's own keyframes, and the question's terms.
#[derive(Clone, Debug)]
pub struct LocateQuestion {
    /// The keyframes, of one moment or one short drive; the pose that is sought is the first one's.
    pub keyframes: Vec<AskedKeyframe>,
    /// Keyframes that are no candidates, in any map.
    pub without_keyframes: BTreeSet<KeyframeId>,
    /// Sessions whose keyframes are no candidates, in any map.
    pub without_sessions: BTreeSet<SessionId>,
    /// The roles that models fill where the question is answered.
    pub roles: Roles,
    /// The position in some session's frame, and the radius, both in metres, within which the camera may be.
    pub hint: Option<(Point3, f64)>,
    /// The seed of geometry's samples.
    pub seed: u64,
}

impl LocateQuestion {
    /// Whether no keyframe has words.
    pub fn is_without_words(&self) -> bool {
        self.keyframes.iter().all(|asked| asked.keyframe.bow.is_empty())
    }

    /// Returns the transformation from a keyframe's own frame to the first keyframe's camera frame; none where their
    /// clients told no poses, so that nothing ties the two together.
    pub fn reference_from_session(&self, keyframe: usize) -> Option<Pose> {
        let (first, asked) = (self.keyframes.first()?, self.keyframes.get(keyframe)?);
        let is_tied = keyframe == 0 || (first.has_pose && asked.has_pose);
        is_tied.then(|| first.keyframe.map_from_camera.inverse())
    }

    /// Returns the transformation from a keyframe's camera frame to the first one's.
    pub fn reference_from_camera(&self, keyframe: usize) -> Option<Pose> {
        let asked = self.keyframes.get(keyframe)?;
        Some(self.reference_from_session(keyframe)?.after(&asked.keyframe.map_from_camera))
    }
}

/// A candidate of one keyframe.
#[derive(Clone, Debug)]
pub struct Proposed {
    /// Its site, by its number.
    pub site: usize,
    /// The signs that agree and contradict.
    pub signs: SignEvidence,
    /// Whether it lies where the hint has the camera.
    pub is_hinted: bool,
}

/// The findings of one map.
#[derive(Clone, Debug, Default)]
pub struct MapSearch {
    /// The map's version.
    pub version: u64,
    /// Whether no words were compared.
    pub is_without_words: bool,
    /// For each keyframe that asks, its candidates after checks 1 to 3.
    pub screenings: Vec<Screening>,
    /// For each keyframe that asks, the same candidates in the same order.
    pub proposed: Vec<Vec<Proposed>>,
    /// The sites of all candidates and poses.
    pub sites: Vec<Site>,
    /// The pairs of sites that show one place, the smaller number first.
    pub beside: BTreeSet<(usize, usize)>,
    /// Poses from anchors, each with its site.
    pub poses: Vec<(AnchorPose, Option<usize>)>,
    /// The names of the sessions of those poses; a plan's frame is one.
    pub pose_sessions: Vec<SessionId>,
    /// The plans to which the sessions of sites and poses are aligned. A plan's own frame is aligned to itself.
    pub plans: BTreeMap<SessionSeq, InPlan>,
    /// The plans' frames among those of the poses.
    pub plan_frames: BTreeSet<SessionSeq>,
}

/// The plan to which a session is aligned.
#[derive(Clone, Debug, PartialEq)]
pub struct InPlan {
    /// The plan's frame.
    pub frame: SessionSeq,
    /// Its name.
    pub frame_id: SessionId,
    /// Maps points of the session's frame into the plan's frame.
    pub plan_from_session: Pose,
}

impl MapSearch {
    /// Whether two sites show one place.
    pub fn are_beside(&self, a: usize, b: usize) -> bool {
        a == b || self.beside.contains(&(a.min(b), a.max(b)))
    }
}

/// Searches one map at one version.
pub fn search_map(index: &MapIndex, version: u64, question: &LocateQuestion) -> MapSearch {
    let left_out = left_out(index, question);
    let queries: Vec<Query<'_>> = question
        .keyframes
        .iter()
        .map(|asked| {
            Query::unplaced(index, &asked.keyframe).with_roles(question.roles).without(left_out.clone())
        })
        .collect();
    let mut sites = Sites::new(index);
    let (mut screenings, mut proposed) = (Vec::new(), Vec::new());
    for query in &queries {
        let (screening, of_query) = propose(index, version, question, query, &mut sites);
        screenings.push(screening);
        proposed.push(of_query);
    }
    let mut alignments = Alignments::of(index);
    let poses = poses(index, question, &queries, &mut sites, &mut alignments);
    let name = |session: SessionSeq| index.sessions()[session.index()].clone();
    let pose_sessions = poses.iter().map(|(pose, _)| name(pose.session)).collect();
    let beside = sites.beside();
    let sites = sites.found;
    let sessions: BTreeSet<SessionSeq> =
        sites.iter().map(|site| site.session).chain(poses.iter().map(|(pose, _)| pose.session)).collect();
    let plan_frames = sessions.iter().copied().filter(|session| index.priors().is_frame(*session)).collect();
    let in_plan = |session: SessionSeq| {
        let (frame, plan_from_session) = if index.priors().is_frame(session) {
            (session, Pose::identity())
        } else {
            let alignment = alignments.session(session)?;
            (alignment.frame, alignment.plan_from_session)
        };
        Some((session, InPlan { frame, frame_id: name(frame), plan_from_session }))
    };
    let plans = sessions.into_iter().filter_map(in_plan).collect();
    let is_without_words = question.is_without_words();
    MapSearch {
        version,
        is_without_words,
        screenings,
        proposed,
        sites,
        beside,
        poses,
        pose_sessions,
        plans,
        plan_frames,
    }
}

fn left_out(index: &MapIndex, question: &LocateQuestion) -> BTreeSet<KeyframeSeq> {
    let named = question.without_keyframes.iter().filter_map(|id| index.keyframe_seq(id));
    let sessions: BTreeSet<SessionSeq> =
        question.without_sessions.iter().filter_map(|id| index.session(id)).collect();
    let mut left_out: BTreeSet<KeyframeSeq> = named.collect();
    if !sessions.is_empty() {
        let of_sessions = index.keyframes().filter(|keyframe| sessions.contains(&keyframe.session));
        left_out.extend(of_sessions.map(|keyframe| keyframe.seq));
    }
    left_out
}

/// Finds the candidates of one keyframe, and takes them through check 3.
fn propose(
    index: &MapIndex,
    version: u64,
    question: &LocateQuestion,
    query: &Query<'_>,
    sites: &mut Sites<'_>,
) -> (Screening, Vec<Proposed>) {
    let mut counts = Counts::around(index, &query.centre);
    let proposals = find_candidates(index, query, &mut counts.places);
    // Geometry's needs are gathered for the few that it looks at.
    let anchors = AnchorCheck::new(index, query, Verify::Anchors, &mut counts);
    let (mut candidates, mut proposed) = (Vec::new(), Vec::new());
    for (keyframe, score, channels) in most_promising(index, &proposals) {
        let Some(candidate) = proposals.unchecked(index, keyframe, score, channels) else { continue };
        let checked = anchors.check(keyframe, candidate, &mut counts);
        let Some((checked, site)) = checked.zip(sites.of(keyframe, &mut counts.places)) else { continue };
        let pre_verified = opened(checked);
        let signs = sign_evidence(index, query, &pre_verified.candidate, &mut counts.places);
        let centre = sites.found[site].map_from_camera.centre();
        let is_hinted =
            question.hint.is_none_or(|(position, radius_m)| (centre - position).norm() <= radius_m);
        candidates.push(pre_verified);
        proposed.push(Proposed { site, signs, is_hinted });
    }
    (Screening::of_candidates(index, version, query, Verify::Auto, candidates), proposed)
}

/// Returns the candidates of a map that are looked at: the best keyframe of each place, and the keyframes of the place that
/// look most like the question, for one view is not the other. The order of the places is fused with that of the words.
fn most_promising<'p>(
    index: &MapIndex,
    proposals: &'p Proposals,
) -> Vec<(KeyframeSeq, Score, &'p [Channel])> {
    let mut found: BTreeMap<KeyframeSeq, (Score, &[Channel])> = BTreeMap::new();
    for proposal in &proposals.candidates {
        for (keyframe, score) in &proposal.neighbours {
            found.entry(*keyframe).or_insert((*score, &proposal.channels));
        }
    }
    for proposal in &proposals.candidates {
        found.insert(proposal.keyframe, (proposal.score, &proposal.channels));
    }
    let id = |keyframe| index.keyframe(keyframe).map(|stored| &stored.id);
    let by_id = |a: KeyframeSeq, b: KeyframeSeq| id(a).cmp(&id(b));
    let mut by_words: Vec<KeyframeSeq> = found.keys().copied().collect();
    by_words.sort_by(|a, b| found[b].0.units().cmp(&found[a].0.units()).then_with(|| by_id(*a, *b)));
    let by_place = proposals.candidates.iter().map(|proposal| proposal.keyframe).collect();
    let fused = fuse(&[((), by_words), ((), by_place)], by_id);
    let kept = fused.into_iter().take(CANDIDATES_PER_MAP_MAX);
    kept.map(|(keyframe, _)| (keyframe, found[&keyframe].0, found[&keyframe].1)).collect()
}

/// Returns a candidate that geometry may look at, whatever its anchors say: where nothing is known of one's own place,
/// everything that looks alike counts, if only as a rival.
fn opened(checked: PreVerified) -> PreVerified {
    match checked.stage {
        Stage::Stopped => PreVerified { stage: Stage::AskGeometry, ..checked },
        Stage::AnchorsAgree | Stage::AskGeometry => checked,
    }
}

impl MapSearch {
    /// Returns the keyframes of these candidates, each by the numbers of the keyframe that asks and of the candidate.
    pub fn keyframes_of(&self, chosen: &[(usize, usize)]) -> Vec<KeyframeSeq> {
        chosen
            .iter()
            .map(|(asked, candidate)| self.screenings[*asked].candidates[*candidate].keyframe)
            .collect()
    }

    /// Takes what geometry needs of these candidates, in the same order.
    pub fn set_snapshots(&mut self, chosen: &[(usize, usize)], snapshots: Vec<Option<GeometrySnapshot>>) {
        for ((asked, candidate), snapshot) in chosen.iter().zip(snapshots) {
            self.screenings[*asked].candidates[*candidate].snapshot = snapshot;
        }
    }
}

/// Gathers what geometry needs of some keyframes.
pub fn snapshots(index: &MapIndex, keyframes: &[KeyframeSeq]) -> Vec<Option<GeometrySnapshot>> {
    keyframes.iter().map(|keyframe| GeometrySnapshot::stored(index, *keyframe)).collect()
}

/// Returns the identifiers that agree and hang in one place only, and how many contradict.
fn sign_evidence(
    index: &MapIndex,
    query: &Query<'_>,
    candidate: &Candidate,
    places: &mut PlaceCounts,
) -> SignEvidence {
    let Some(anchors) = &candidate.anchors else { return SignEvidence::default() };
    let mut agreeing = BTreeSet::new();
    for pair in &anchors.matches {
        let AnchorName::Inline(detection) = &pair.query_anchor else { continue };
        let sighted = query.centre.inline.iter().find(|anchor| anchor.detection == *detection);
        let Some((class, text)) = sighted.and_then(|anchor| Some((&anchor.class, anchor.text.as_ref()?)))
        else {
            continue;
        };
        if text.has_name() && places.of_guest(index, class, text) == 1 {
            agreeing.insert(text.gist().to_owned());
        }
    }
    SignEvidence {
        agreeing: agreeing.into_iter().collect(),
        contradicting: anchors.contradictions.len() as u32,
    }
}

/// Returns the poses that anchors give, in each session's frame.
fn poses(
    index: &MapIndex,
    question: &LocateQuestion,
    queries: &[Query<'_>],
    sites: &mut Sites<'_>,
    alignments: &mut Alignments<'_>,
) -> Vec<(AnchorPose, Option<usize>)> {
    let mut sighted: Vec<SightedAnchor> = Vec::new();
    for (number, query) in queries.iter().enumerate() {
        if let Some(reference_from_session) = question.reference_from_session(number) {
            sighted.extend(sighted_anchors(index, query, number, &reference_from_session));
        }
    }
    let Some(first) = queries.first().filter(|_| sighted.len() >= 2) else { return Vec::new() };
    let mut counts = PlaceCounts::around(index, &first.centre);
    let apart_m = index.properties().settings.distinctive_place_radius_m;
    let mut found = Vec::new();
    for (session, pairs) in pairs_by_session(index, &sighted, &mut counts, alignments) {
        let objects: BTreeSet<AnchorSeq> = pairs.iter().map(|pair| pair.object).collect();
        let seeing = keyframes_seeing(index, session, &objects, first);
        let verticals = verticals(index, &question.keyframes[0].keyframe, &seeing);
        for pose in anchor_poses(session, &sighted, &pairs, &verticals, apart_m) {
            let site = nearest(index, &seeing, &pose.pose.map_from_camera.centre());
            let site = site.and_then(|keyframe| sites.of(keyframe, &mut counts));
            found.push((pose, site));
        }
    }
    found
}

/// Returns the keyframes of a session that see one of these objects and are not left out.
fn keyframes_seeing(
    index: &MapIndex,
    session: SessionSeq,
    objects: &BTreeSet<AnchorSeq>,
    query: &Query<'_>,
) -> Vec<KeyframeSeq> {
    let seen = objects.iter().filter_map(|object| index.objects().get(*object));
    let keyframes: BTreeSet<KeyframeSeq> = seen.flat_map(|object| index.keyframes_of(object)).collect();
    let of_session = |seq: &KeyframeSeq| index.session_of(*seq) == Some(session);
    keyframes.into_iter().filter(|seq| of_session(seq) && !query.left_out.contains(seq)).collect()
}

/// Returns the verticals of the camera and of a session of which keyframes are given. Gravity counts where it is told: by the
/// camera, and by the map or these keyframes. Where either side does not tell, the session's cameras and this one are taken to
/// be equally upright.
fn verticals(index: &MapIndex, asked: &NewKeyframe, seeing: &[KeyframeSeq]) -> Verticals {
    let stored = || seeing.iter().filter_map(|seq| index.keyframe(*seq));
    let mean = |sum: Vector3<f64>| sum.try_normalize(1e-6);
    let told = stored().filter_map(|keyframe| {
        Some(keyframe.map_from_camera.isometry().rotation * keyframe.gravity?.direction())
    });
    let of_map = index.properties().gravity.map(|gravity| gravity.direction());
    let of_session = of_map.or_else(|| mean(told.fold(Vector3::zeros(), |sum, down| sum + down)));
    if let Some((own, down_in_session)) = asked.gravity.zip(of_session) {
        return Verticals { down_in_camera: own.direction(), down_in_session, is_assumed: false };
    }
    let upright = stored().fold(Vector3::zeros(), |sum, keyframe| {
        sum + keyframe.map_from_camera.isometry().rotation * Vector3::y()
    });
    Verticals {
        down_in_camera: Vector3::y(),
        down_in_session: mean(upright).unwrap_or_else(|| -Vector3::z()),
        is_assumed: true,
    }
}

/// Returns the keyframe nearest to a point, ties to the smallest id.
fn nearest(index: &MapIndex, keyframes: &[KeyframeSeq], point: &Point3) -> Option<KeyframeSeq> {
    let stored = keyframes.iter().filter_map(|seq| index.keyframe(*seq));
    let apart = |pose: &Pose| (pose.centre() - point).norm();
    let nearest = stored.min_by(|a, b| {
        apart(&a.map_from_camera).total_cmp(&apart(&b.map_from_camera)).then_with(|| a.id.cmp(&b.id))
    });
    nearest.map(|keyframe| keyframe.seq)
}
