//! Traces: a span for each request, sent to an OpenTelemetry collector where one is configured.
//!
//! Spans of traces have a target of their own: logs do not show them, and what libraries log does not become part of a
//! trace. Without a collector nothing is made, sent or remembered.

#[cfg_attr(not(feature = "otel"), path = "traces/no_collector.rs")]
mod collector;

use tracing::Span;

pub use collector::{TraceArgs, Traces};

/// The target of spans that are for traces only.
pub const TARGET: &str = "revisit::trace";

/// Returns the span of a request, under the one that its caller tells in `traceparent`. None of this happens without a
/// collector.
pub fn request_span(id: &str, method: &str, route: &str, header: impl Fn(&str) -> Option<String>) -> Span {
    let span = tracing::info_span!(
        target: TARGET, "request", otel.name = format!("{method} {route}"), otel.kind = "server",
        otel.status_code = tracing::field::Empty, http.request.method = method, http.route = route,
        http.response.status_code = tracing::field::Empty, request_id = id,
    );
    if !span.is_disabled() {
        collector::set_parent(&span, header);
    }
    span
}

/// Returns a part of what a request takes its time for, under the span that is entered.
pub fn part(name: &'static str) -> Span {
    tracing::info_span!(target: TARGET, "part", otel.name = name)
}

/// How the request of a span ended.
pub fn answered(span: &Span, status: u16) {
    span.record("http.response.status_code", status);
    if status >= 500 {
        span.record("otel.status_code", "ERROR");
    }
}
