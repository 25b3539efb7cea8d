//! Query: the query parameters, validated together. An unknown parameter is an error.

use axum::extract::FromRequestParts;
use axum::http::request::Parts;
use serde_json::Value;
use utoipa::IntoParams;

use crate::api::decoding::document::Document;
use crate::api::decoding::read::{self, Decode, Node, Object};
use crate::api::limits;
use crate::domain::anchor::AnchorState;
use crate::domain::ids::ReleaseName;
use crate::domain::invalid::FieldError;
use crate::domain::reason::ReasonCode;
use crate::domain::request::{AnchorFilter, Detail};
use crate::domain::verdict::Decision;
use crate::domain::verdict_line::VerdictFilter;
use crate::http::problem::{Kind, Problem};

/// A request's parameters, decoded into the model.
pub struct Query<T>(pub T);

impl<T: Decode, S: Send + Sync> FromRequestParts<S> for Query<T> {
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, _: &S) -> Result<Self, Problem> {
        let malformed = |_| Problem::new(Kind::BAD_REQUEST, "the query is not percent-encoded UTF-8");
        let pairs =
            axum::extract::Query::<Vec<(String, String)>>::try_from_uri(&parts.uri).map_err(malformed)?.0;
        let again = |at: usize| pairs[..at].iter().any(|(name, _)| *name == pairs[at].0);
        if let Some(at) = (0..pairs.len()).find(|&at| again(at)) {
            return Err(Problem::invalid(vec![FieldError::new(format!("?{}", pairs[at].0), "given twice")]));
        }
        // Decoded as an object of strings, so that bodies and parameters share one error reporter.
        let object =
            Value::Object(pairs.into_iter().map(|(name, text)| (name, Value::String(text))).collect());
        read::decode(&Document::from(&object)).map(Self).map_err(|mut faults| {
            for fault in &mut faults {
                fault.pointer.replace_range(..fault.pointer.len().min(1), "?");
            }
            Problem::invalid(faults)
        })
    }
}

/// The page of a list.
#[derive(Clone, Debug, PartialEq, Eq, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct Paging {
    /// Maximum number of items.
    #[param(minimum = 1, maximum = 1000, default = 100, required = false)]
    pub limit: usize,
    /// Start of the page: `next_cursor` of the previous one.
    #[param(max_length = 256)]
    pub cursor: Option<String>,
}

/// A filter of keyframes.
#[derive(IntoParams)]
#[into_params(parameter_in = Query)]
#[expect(dead_code, reason = "documents what the reader reads")]
pub struct KeyframeSearch {
    /// Only keyframes that may be deleted when a quota nears: others see 90 % of their map points and every anchor.
    #[param(default = false)]
    redundant: Option<bool>,
}

/// A filter of keyframes, and a page of the result.
pub struct KeyframePage {
    /// Whether only redundant ones are asked for.
    pub redundant: bool,
    /// The page.
    pub page: Paging,
}

/// A filter of anchors.
#[derive(IntoParams)]
#[into_params(parameter_in = Query)]
#[expect(dead_code, reason = "documents what the reader reads")]
pub struct AnchorSearch {
    /// Only anchors of this class.
    #[param(min_length = 1, max_length = 64)]
    class: Option<String>,
    /// Only anchors whose description contains these words.
    #[param(max_length = 4096)]
    text: Option<String>,
    /// Only anchors in this state.
    #[param(inline)]
    state: Option<crate::api::names::AnchorStateName>,
    /// Include anchors that were merged into another.
    #[param(default = false)]
    merged: Option<bool>,
    /// Only prior anchors, or only those that robots saw.
    prior: Option<bool>,
}

/// A filter of anchors, and a page of the result.
pub struct AnchorPage {
    /// The filter.
    pub filter: AnchorFilter,
    /// The page.
    pub page: Paging,
}

/// A filter of verdicts. What is left out admits all.
#[derive(IntoParams)]
#[into_params(parameter_in = Query)]
#[expect(dead_code, reason = "documents what the reader reads")]
pub struct VerdictSearch {
    /// Only this answer.
    #[param(inline)]
    verdict: Option<crate::api::names::VerdictName>,
    /// Only those that this check decided.
    #[param(inline)]
    reason: Option<crate::api::names::ReasonCodeName>,
    /// Only those about keyframes of this session.
    #[param(min_length = 1, max_length = 128)]
    session: Option<String>,
    /// Only those asked from this time on, in whole seconds since 1970.
    #[param(minimum = 0)]
    since: Option<u64>,
    /// Only those asked before this time, in whole seconds since 1970.
    #[param(minimum = 0)]
    until: Option<u64>,
    /// Those that were asked of this release of the map, instead of the map itself.
    #[param(min_length = 1, max_length = 64)]
    release: Option<String>,
}

/// A filter of verdicts, and a page of the result.
pub struct VerdictPage {
    /// The filter.
    pub filter: VerdictFilter,
    /// The release that was asked.
    pub release: Option<ReleaseName>,
    /// The page.
    pub page: Paging,
}

/// The start of an event stream.
#[derive(Clone, Debug, PartialEq, Eq, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct Since {
    /// The number of the last event seen; 0, the default, is before the first. `last-event-id` overrides it.
    #[param(minimum = 0)]
    pub since: Option<u64>,
}

/// The optional query of a keyframe's PUT.
#[derive(Clone, Debug, PartialEq, Eq, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct KeyframeParams {
    /// `loop`: return the answer of a loop query in the same round trip.
    #[param(value_type = Option<String>, pattern = "^loop$")]
    pub query: Option<AskLoop>,
    /// How much of that answer is returned.
    #[param(value_type = Option<crate::api::names::DetailName>, inline)]
    pub detail: Detail,
}

/// How much of an answer is returned.
#[derive(Clone, Copy, Debug, PartialEq, Eq, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct DetailParams {
    /// How much of the answer is returned.
    #[param(value_type = Option<crate::api::names::DetailName>, inline)]
    pub detail: Detail,
}

/// The only query that a PUT supports.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AskLoop;

/// Whether the last administrator key may be revoked.
#[derive(Clone, Copy, Debug, PartialEq, Eq, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct LastAdmin {
    /// Revoke the key even if no administrator key is left; then only `revisit keys create` creates one.
    #[param(default = false, required = false)]
    pub last_admin: bool,
}

impl Decode for LastAdmin {
    fn decode(node: &Node<'_>) -> Option<Self> {
        let query = node.object(&["last_admin"])?;
        let last_admin =
            query.optional("last_admin", |node| node.choice(&["true", "false"], |text| text.parse().ok()));
        Some(Self { last_admin: last_admin?.unwrap_or(false) })
    }
}

impl Decode for Paging {
    fn decode(node: &Node<'_>) -> Option<Self> {
        paging(&node.object(&["limit", "cursor"])?)
    }
}

fn paging(query: &Object<'_>) -> Option<Paging> {
    let limit = query.optional("limit", |node| node.digits(limits::PAGE));
    let cursor = query.optional("cursor", |node| node.name(limits::CURSOR_CHARS));
    Some(Paging { limit: limit?.map_or(limits::PAGE_DEFAULT, |limit| limit as usize), cursor: cursor? })
}

impl Decode for KeyframePage {
    fn decode(node: &Node<'_>) -> Option<Self> {
        let query = node.object(&["redundant", "limit", "cursor"])?;
        let page = paging(&query);
        let redundant =
            query.optional("redundant", |node| node.choice(&["true", "false"], |text| text.parse().ok()));
        Some(Self { redundant: redundant?.unwrap_or(false), page: page? })
    }
}

impl Decode for AnchorPage {
    fn decode(node: &Node<'_>) -> Option<Self> {
        let query = node.object(&["class", "text", "state", "merged", "prior", "limit", "cursor"])?;
        let page = paging(&query);
        let class = query.optional("class", |node| node.name(limits::CLASS_CHARS));
        let text = query.optional("text", |node| node.text(limits::TEXT_CHARS));
        let state = query.optional("state", |node| node.choice(AnchorState::NAMES, AnchorState::from_name));
        let merged =
            query.optional("merged", |node| node.choice(&["true", "false"], |text| text.parse().ok()));
        let prior = query.optional("prior", |node| node.choice(&["true", "false"], |text| text.parse().ok()));
        let filter = AnchorFilter {
            class: class?,
            text: text?,
            state: state?,
            merged: merged?.unwrap_or(false),
            prior: prior?,
        };
        Some(Self { filter, page: page? })
    }
}

impl Decode for VerdictPage {
    fn decode(node: &Node<'_>) -> Option<Self> {
        let query =
            node.object(&["verdict", "reason", "session", "since", "until", "release", "limit", "cursor"])?;
        let page = paging(&query);
        let decision = query.optional("verdict", |node| node.choice(Decision::NAMES, Decision::from_name));
        let reason = query.optional("reason", |node| node.choice(ReasonCode::NAMES, ReasonCode::from_name));
        let session = query.optional("session", read::id);
        let since = query.optional("since", |node| node.digits(limits::SEED));
        let until = query.optional("until", |node| node.digits(limits::SEED));
        let release = query.optional("release", read::id);
        let filter = VerdictFilter {
            decision: decision?,
            reason: reason?,
            session: session?,
            since_s: since?,
            until_s: until?,
        };
        Some(Self { filter, release: release?, page: page? })
    }
}

impl Decode for Since {
    fn decode(node: &Node<'_>) -> Option<Self> {
        let query = node.object(&["since"])?;
        let since = query.optional("since", |node| node.digits(limits::SEED));
        Some(Self { since: since?.map(i64::unsigned_abs) })
    }
}

impl Decode for KeyframeParams {
    fn decode(node: &Node<'_>) -> Option<Self> {
        let query = node.object(&["query", "detail"])?;
        let ask = query
            .optional("query", |node| node.choice(&["loop"], |text| (text == "loop").then_some(AskLoop)));
        let detail = detail(&query);
        Some(Self { query: ask?, detail: detail? })
    }
}

impl Decode for DetailParams {
    fn decode(node: &Node<'_>) -> Option<Self> {
        let query = node.object(&["detail"])?;
        Some(Self { detail: detail(&query)? })
    }
}

fn detail(query: &Object<'_>) -> Option<Detail> {
    let detail = query.optional("detail", |node| node.choice(Detail::NAMES, Detail::from_name));
    Some(detail?.unwrap_or_default())
}
