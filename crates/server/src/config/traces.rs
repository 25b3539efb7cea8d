//! Traces: a span for each request, sent to an OpenTelemetry collector where one is configured.
//!
//! Spans of traces have their own target, so logs do not show them, and log lines of libraries do not become part of a
//! trace. Without a collector no span is created, sent or stored.

#[cfg_attr(not(feature = "otel"), path = "traces/no_collector.rs")]
mod collector;

use tracing::Span;

pub use collector::{TraceArgs, Traces};

/// The target of spans that are for traces only.
pub const TARGET: &str = "revisit::trace";

/// Returns the span of a request, under the parent in `traceparent`. Without a collector it is disabled.
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

/// Returns a span for a part of a request, under the current span.
pub fn part(name: &'static str) -> Span {
    tracing::info_span!(target: TARGET, "part", otel.name = name)
}

/// Records the status of a request in its span.
pub fn answered(span: &Span, status: u16) {
    span.record("http.response.status_code", status);
    if status >= 500 {
        span.record("otel.status_code", "ERROR");
    }
}
