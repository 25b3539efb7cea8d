//! Collector: the destination of traces, and their exporter.

use std::collections::HashMap;
use std::time::Duration;

use clap::Args;
use opentelemetry::propagation::TextMapPropagator as _;
use opentelemetry::trace::TracerProvider as _;
use opentelemetry_otlp::{SpanExporter, WithExportConfig as _, WithHttpConfig as _};
use opentelemetry_sdk::Resource;
use opentelemetry_sdk::propagation::TraceContextPropagator;
use opentelemetry_sdk::trace::SdkTracerProvider;
use tracing::{Level, Span, Subscriber};
use tracing_opentelemetry::OpenTelemetrySpanExt as _;
use tracing_subscriber::Layer;
use tracing_subscriber::filter::Targets;
use tracing_subscriber::registry::LookupSpan;

use crate::config::{build, tls};

/// The path for traces below a collector's base address.
const PATH: &str = "/v1/traces";

/// Time to send the remaining spans at shutdown.
const FLUSH: Duration = Duration::from_secs(5);

/// The destination of traces.
#[derive(Args, Clone, Debug, Default)]
pub struct TraceArgs {
    /// An OpenTelemetry collector that receives traces by OTLP over HTTP, such as http://127.0.0.1:4318; without it
    /// none are sent. OTEL_EXPORTER_OTLP_ENDPOINT, OTEL_SERVICE_NAME, OTEL_TRACES_SAMPLER and similar variables are
    /// honoured
    #[arg(long, env = "REVISIT_OTLP_ENDPOINT", value_name = "URL")]
    pub otlp_endpoint: Option<String>,
}

/// The exporter of traces.
#[derive(Debug, Default)]
pub struct Traces {
    provider: Option<SdkTracerProvider>,
}

impl TraceArgs {
    /// Returns the address for traces, from the flag or from OpenTelemetry's own variables.
    fn address(&self) -> Option<String> {
        let variable = |name: &str| std::env::var(name).ok().filter(|value| !value.is_empty());
        let is_off = variable("OTEL_SDK_DISABLED").is_some_and(|value| value.eq_ignore_ascii_case("true"))
            || variable("OTEL_TRACES_EXPORTER").is_some_and(|value| value == "none");
        if is_off && self.otlp_endpoint.is_none() {
            return None;
        }
        let below = |base: String| match base.trim_end_matches('/') {
            whole if whole.ends_with(PATH) => whole.to_owned(),
            base => format!("{base}{PATH}"),
        };
        let own = self.otlp_endpoint.clone().map(below);
        own.or_else(|| variable("OTEL_EXPORTER_OTLP_TRACES_ENDPOINT"))
            .or_else(|| variable("OTEL_EXPORTER_OTLP_ENDPOINT").map(below))
    }
}

impl Traces {
    /// Prepares the exporter, if a collector is configured.
    pub fn start(args: &TraceArgs) -> Result<Self, String> {
        let Some(address) = args.address() else { return Ok(Self::default()) };
        // The client has its own runtime, which cannot be created within another one.
        let provider = std::thread::spawn(move || provider(&address)).join();
        let provider = provider.map_err(|_| "the client for traces failed".to_owned())??;
        Ok(Self { provider: Some(provider) })
    }

    /// Whether a collector is configured.
    pub fn are_sent(&self) -> bool {
        self.provider.is_some()
    }

    /// Returns the layer that exports the spans of a target.
    pub fn layer<S: Subscriber + for<'span> LookupSpan<'span>>(
        &self,
        target: &str,
    ) -> Option<impl Layer<S> + use<S>> {
        let tracer = self.provider.as_ref()?.tracer(build::NAME);
        let layer =
            tracing_opentelemetry::layer().with_tracer(tracer).with_location(false).with_threads(false);
        let layer = layer.with_target(false).with_level(false);
        Some(layer.with_filter(Targets::new().with_target(target, Level::INFO)))
    }

    /// Sends the remaining spans.
    pub async fn flush(self) {
        let Some(provider) = self.provider else { return };
        let flushed = tokio::task::spawn_blocking(move || provider.shutdown_with_timeout(FLUSH)).await;
        if let Ok(Err(error)) = flushed {
            tracing::warn!(%error, "the last traces may not have reached the collector");
        }
    }
}

fn provider(address: &str) -> Result<SdkTracerProvider, String> {
    let client = tls::blocking_client_for(address).build().map_err(|error| format!("traces: {error}"))?;
    let exporter = SpanExporter::builder().with_http().with_http_client(client).with_endpoint(address);
    let exporter = exporter.build().map_err(|error| format!("--otlp-endpoint {address}: {error}"))?;
    let resource = Resource::builder();
    let resource = match std::env::var_os("OTEL_SERVICE_NAME") {
        Some(_) => resource,
        None => resource.with_service_name(build::NAME),
    };
    let resource = resource.with_attribute(opentelemetry::KeyValue::new("service.version", build::VERSION));
    Ok(SdkTracerProvider::builder().with_resource(resource.build()).with_batch_exporter(exporter).build())
}

/// Sets the parent of a span from the headers of the request, by W3C Trace Context.
pub(super) fn set_parent(span: &Span, header: impl Fn(&str) -> Option<String>) {
    let headers = ["traceparent", "tracestate"].map(|name| Some((name.to_owned(), header(name)?)));
    let headers: HashMap<String, String> = headers.into_iter().flatten().collect();
    let parent = TraceContextPropagator::new().extract(&headers);
    // Fails only once the span has started.
    let _ = span.set_parent(parent);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_path_of_traces_is_added_once() {
        for (given, expected) in [
            ("http://127.0.0.1:4318", "http://127.0.0.1:4318/v1/traces"),
            ("http://127.0.0.1:4318/", "http://127.0.0.1:4318/v1/traces"),
            ("http://127.0.0.1:4318/v1/traces", "http://127.0.0.1:4318/v1/traces"),
            ("https://collector.example/otlp", "https://collector.example/otlp/v1/traces"),
        ] {
            let args = TraceArgs { otlp_endpoint: Some(given.to_owned()) };
            assert_eq!(args.address().as_deref(), Some(expected));
        }
    }
}
