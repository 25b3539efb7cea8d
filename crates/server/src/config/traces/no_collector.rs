//! No collector: without the feature `otel` the program sends no traces and has no flags for them.

use clap::Args;
use tracing::{Span, Subscriber};
use tracing_subscriber::Layer;
use tracing_subscriber::layer::Identity;

/// The destination of traces: none.
#[derive(Args, Clone, Debug, Default)]
pub struct TraceArgs {}

/// Traces that are not sent.
#[derive(Debug, Default)]
pub struct Traces;

impl Traces {
    /// Prepares nothing.
    pub fn start(_: &TraceArgs) -> Result<Self, String> {
        Ok(Self)
    }

    /// Whether there is a collector.
    pub fn are_sent(&self) -> bool {
        false
    }

    /// Returns no layer.
    pub fn layer<S: Subscriber>(&self, _: &str) -> Option<impl Layer<S> + use<S>> {
        None::<Identity>
    }

    /// Sends nothing.
    #[expect(clippy::unused_async, reason = "the same call as with a collector")]
    pub async fn flush(self) {}
}

pub(super) fn set_parent(_: &Span, _: impl Fn(&str) -> Option<String>) {}
