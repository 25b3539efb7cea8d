//! Query: the query parameters, validated together. An unknown parameter is an error.

use axum::extract::FromRequestParts;
use axum::http::request::Parts;
use revisit_shapes::params;

use crate::api::decoding::document::Document;
use crate::api::decoding::read::{self, Decode, Node};
use crate::api::names::{AnchorStateName, DetailName, ReasonCodeName, VerdictName};
use crate::api::trajectory::TrajectoryFormat;
use crate::domain::ids::{ReleaseName, SessionId};
use crate::domain::invalid::FieldError;
use crate::domain::request::{AnchorFilter, Detail, PageRequest};
use crate::domain::verdict_line::VerdictFilter;
use crate::http::problem::{Kind, Problem};

/// A request's parameters, decoded into the model.
pub struct Query<T>(pub T);

impl<T: Decode, S: Send + Sync> FromRequestParts<S> for Query<T> {
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, _: &S) -> Result<Self, Problem> {
        let malformed = |_| Problem::new(Kind::BAD_REQUEST, "the query is not percent-encoded UTF-8");
        let mut pairs =
            axum::extract::Query::<Vec<(String, String)>>::try_from_uri(&parts.uri).map_err(malformed)?.0;
        let again = |at: usize| pairs[..at].iter().any(|(name, _)| *name == pairs[at].0);
        if let Some(at) = (0..pairs.len()).find(|&at| again(at)) {
            return Err(Problem::invalid(vec![FieldError::new(format!("?{}", pairs[at].0), "given twice")]));
        }
        // Decoded as an object of strings, so that bodies and parameters share one error reporter.
        pairs.sort_unstable();
        read::decode(&Document::of_texts(&pairs)).map(Self).map_err(|mut faults| {
            for fault in &mut faults {
                fault.pointer.replace_range(..fault.pointer.len().min(1), "?");
            }
            Problem::invalid(faults)
        })
    }
}

/// The page of a list.
#[params]
pub struct Paging {
    /// Maximum number of items.
    #[param(minimum = 1, maximum = 1000, default = 100)]
    pub limit: usize,
    /// Start of the page: `next_cursor` of the previous one.
    #[param(min_length = 1, max_length = 256)]
    pub cursor: Option<String>,
}

impl From<Paging> for PageRequest {
    fn from(Paging { limit, cursor }: Paging) -> Self {
        Self { cursor, limit }
    }
}

/// A filter of keyframes.
#[params]
pub struct KeyframeSearch {
    /// Only keyframes that may be deleted when a quota nears: others see 90 % of their map points and every anchor.
    #[param(default = false)]
    pub redundant: bool,
}

/// A filter of anchors.
#[params]
pub struct AnchorSearch {
    /// Only anchors of this class.
    #[param(min_length = 1, max_length = 64)]
    class: Option<String>,
    /// Only anchors whose description contains these words.
    #[param(max_length = 4096)]
    text: Option<String>,
    /// Only anchors in this state.
    #[param(inline)]
    state: Option<AnchorStateName>,
    /// Include anchors that were merged into another.
    #[param(default = false)]
    merged: bool,
    /// Only prior anchors, or only those that robots saw.
    prior: Option<bool>,
}

impl From<AnchorSearch> for AnchorFilter {
    fn from(AnchorSearch { class, text, state, merged, prior }: AnchorSearch) -> Self {
        Self { class, text, state: state.map(|state| state.0), merged, prior }
    }
}

/// A filter of verdicts. What is left out admits all.
#[params]
pub struct VerdictSearch {
    /// Only this answer.
    #[param(inline)]
    verdict: Option<VerdictName>,
    /// Only those that this check decided.
    #[param(inline)]
    reason: Option<ReasonCodeName>,
    /// Only those about keyframes of this session.
    #[id]
    session: Option<SessionId>,
    /// Only those asked from this time on, in whole seconds since 1970.
    #[param(minimum = 0)]
    since: Option<i64>,
    /// Only those asked before this time, in whole seconds since 1970.
    #[param(minimum = 0)]
    until: Option<i64>,
    /// Those that were asked of this release of the map, instead of the map itself.
    #[id]
    pub release: Option<ReleaseName>,
}

impl From<VerdictSearch> for VerdictFilter {
    fn from(asked: VerdictSearch) -> Self {
        Self {
            decision: asked.verdict.map(|verdict| verdict.0),
            reason: asked.reason.map(|reason| reason.0),
            session: asked.session,
            since_s: asked.since,
            until_s: asked.until,
        }
    }
}

/// The start of an event stream.
#[params]
pub struct Since {
    /// The number of the last event seen; 0, the default, is before the first. `last-event-id` overrides it.
    #[param(minimum = 0)]
    pub since: Option<u64>,
}

/// The optional query of a keyframe's PUT.
#[params]
pub struct KeyframeParams {
    /// `loop`: return the answer of a loop query in the same round trip.
    #[param(value_type = Option<String>, pattern = "^loop$")]
    #[read(|node: &Node<'_>| node.one_of([("loop", ())]))]
    pub query: Option<()>,
    /// How much of that answer is returned.
    #[param(inline)]
    pub detail: Option<DetailName>,
}

/// How much of an answer is returned.
#[params]
pub struct DetailParams {
    /// How much of the answer is returned.
    #[param(inline)]
    pub detail: Option<DetailName>,
}

impl DetailParams {
    /// Returns how much is returned.
    pub fn detail(&self) -> Detail {
        self.detail.unwrap_or_default().0
    }
}

/// Whether the last administrator key may be revoked.
#[params]
pub struct LastAdmin {
    /// Revoke the key even if no administrator key is left; then only `revisit keys create` creates one.
    #[param(default = false)]
    pub last_admin: bool,
}

/// The release that is read, if one was named.
#[params]
pub struct ReleaseQuery {
    /// The release that is read; left out: the map as it stands.
    #[id]
    pub release: Option<ReleaseName>,
}

/// The two versions that are compared.
#[params]
pub struct ChangesQuery {
    /// The release that is the earlier version.
    #[id]
    pub since: ReleaseName,
    /// The release that is the later version; left out: the map as it stands.
    #[id]
    pub until: Option<ReleaseName>,
    /// Maximum number of items of each change.
    #[param(minimum = 1, maximum = 1000, default = 100)]
    pub limit: usize,
}

/// The session in whose frame the others are, if one was chosen.
#[params]
pub struct FramesQuery {
    /// The session in whose frame the others are; left out: the oldest of those that most sessions are joined with.
    #[id]
    pub reference: Option<SessionId>,
}

/// The trajectory to export, and its format.
#[params]
pub struct TrajectoryQuery {
    /// `tum`, `kitti` or `g2o`.
    #[param(value_type = String, pattern = "^(tum|kitti|g2o)$", example = "tum")]
    #[read(|node: &Node<'_>| node.one_of(TrajectoryFormat::NAMED))]
    pub format: TrajectoryFormat,
    /// Only this session; required for `tum` and `kitti` if the map has several.
    #[id]
    #[param(example = "robot-7")]
    pub session: Option<SessionId>,
    /// `session`: each session in its own frame, which is the default. `fleet`: all sessions that loops and plans join, in the frame of
    /// one of them (`GET .../frames`); `tum` and `kitti` then take several sessions, each after a comment with its name; comments name those that nothing joins.
    #[param(value_type = Option<String>, pattern = "^(session|fleet)$")]
    #[read(|node: &Node<'_>| node.one_of([("session", false), ("fleet", true)]))]
    pub frame: Option<bool>,
    /// With `frame=fleet`, the session in whose frame all are.
    #[id]
    pub reference: Option<SessionId>,
}
