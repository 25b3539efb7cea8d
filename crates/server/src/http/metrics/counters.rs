//! Counters: requests, latencies and verdicts for Prometheus.

use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use prometheus_client::encoding::{EncodeLabelSet, text};
use prometheus_client::metrics::counter::Counter;
use prometheus_client::metrics::family::Family;
use prometheus_client::metrics::gauge::Gauge;
use prometheus_client::metrics::histogram::Histogram;
use prometheus_client::metrics::info::Info;
use prometheus_client::registry::{Metric, Registry, Unit};

use super::process::Process;
use crate::config::build;
use crate::domain::key::KeySeq;
use crate::engine::Stats;

/// Upper bounds of the latency histogram, in seconds: a read takes well below a millisecond, a large bulk minutes.
const LATENCY_BOUNDS_S: [f64; 14] =
    [0.0005, 0.001, 0.0025, 0.005, 0.01, 0.025, 0.05, 0.1, 0.25, 0.5, 1.0, 2.5, 10.0, 60.0];

/// The beginning of every name.
const PREFIX: &str = "revisit";

/// Keys that have a label of their own; there may be any number of keys.
const KEYS_NAMED: usize = 100;

/// A label by itself: its name and its value.
type Label<V> = [(&'static str, V); 1];

/// The metrics of one server.
pub struct Metrics {
    registry: Registry,
    requests: Family<RequestLabels, Counter>,
    refusals: Family<Label<u16>, Counter>,
    latency: Family<RouteLabels, Histogram>,
    verdicts: Family<Label<&'static str>, Counter>,
    forwarded: Family<Label<&'static str>, Counter>,
    by_key: Family<Label<String>, Counter>,
    started: Instant,
    open_connections: Gauge<u64, AtomicU64>,
    in_flight: Gauge<u64, AtomicU64>,
    connections: Family<Label<&'static str>, Counter>,
    shed: Family<Label<&'static str>, Counter>,
}

#[derive(Clone, Debug, PartialEq, Eq, Hash, EncodeLabelSet)]
struct RequestLabels {
    method: &'static str,
    route: String,
    status: &'static str,
}

#[derive(Clone, Debug, PartialEq, Eq, Hash, EncodeLabelSet)]
struct RouteLabels {
    method: &'static str,
    route: String,
}

/// Registers a metric.
fn registered<M: Metric + Clone + Default>(registry: &mut Registry, name: &str, help: &str) -> M {
    let metric = M::default();
    registry.register(name, help, metric.clone());
    metric
}

impl Default for Metrics {
    fn default() -> Self {
        let mut registry = Registry::with_prefix(PREFIX);
        let of = &mut registry;
        let requests = registered(of, "http_requests", "Requests by method, route and status");
        let latency =
            Family::new_with_constructor((|| Histogram::new(LATENCY_BOUNDS_S)) as fn() -> Histogram);
        of.register_with_unit("http_request", "Time to answer", Unit::Seconds, latency.clone());
        let verdicts = registered(of, "loop_verdicts", "Loop queries by verdict");
        let forwarded: Family<Label<&'static str>, Counter> =
            registered(of, "forwarded", "Requests about maps of other servers");
        for outcome in ["answered", "copied", "failed"] {
            // Told from the start, so that a rate is one.
            drop(forwarded.get_or_create(&[("outcome", outcome)]));
        }
        let by_key = registered(of, "key_requests", "Requests by key; of more than 100 keys the rest as one");
        let refusals = registered(of, "http_refusals", "Requests rejected or failed, by status");
        of.register("build", "What runs", Info::new(vec![("version", build::VERSION)]));
        Self {
            requests,
            latency,
            verdicts,
            forwarded,
            by_key,
            refusals,
            started: Instant::now(),
            open_connections: registered(of, "connections_open", "Connections open"),
            in_flight: registered(of, "requests_in_flight", "Requests in flight"),
            connections: registered(
                of,
                "connections",
                "Connections accepted, refused without a free slot, or evicted for another",
            ),
            shed: registered(of, "shed", "Requests rejected with 503 at once, by kind"),
            registry,
        }
    }
}

impl Metrics {
    /// The media type of [`Metrics::text`].
    pub const MEDIA_TYPE: &'static str = "application/openmetrics-text; version=1.0.0; charset=utf-8";

    /// Counts a response. The route is the pattern, never the path: one label per id would exhaust the memory.
    pub fn answered(&self, method: &str, route: &str, status: u16, took: Duration) {
        let method = known(method);
        if status >= 400 {
            self.refusals.get_or_create(&[("status", status)]).inc();
        }
        let status = ["1xx", "2xx", "3xx", "4xx", "5xx"][usize::from(status / 100).clamp(1, 5) - 1];
        let route = route.to_owned();
        self.latency.get_or_create(&RouteLabels { method, route: route.clone() }).observe(took.as_secs_f64());
        self.requests.get_or_create(&RequestLabels { method, route, status }).inc();
    }

    /// Sets the connections and requests that are open now.
    pub fn open_now(&self, connections: usize, requests: usize) {
        self.open_connections.set(connections as u64);
        self.in_flight.set(requests as u64);
    }

    /// Counts a connection that was `accepted`, `refused` or `evicted`.
    pub fn connection(&self, fate: &'static str) {
        self.connections.get_or_create(&[("fate", fate)]).inc();
    }

    /// Counts a shed `read`, `write`, large `body` or large `answer`.
    pub fn shed(&self, what: &'static str) {
        self.shed.get_or_create(&[("what", what)]).inc();
    }

    /// Counts a request about a map of another server: `answered` by that one, `copied` from a copy here, or `failed`.
    pub fn forwarded(&self, outcome: &'static str) {
        self.forwarded.get_or_create(&[("outcome", outcome)]).inc();
    }

    /// Returns all metrics: those that are counted here, and figures of this moment. Requests are by each good key, the oldest first.
    pub fn text(&self, stats: &Stats, key_requests: &[(KeySeq, u64)]) -> String {
        for (decision, count) in &stats.verdicts {
            let label = [("verdict", decision.as_str())];
            self.verdicts.get_or_create(&label).inner().store(*count, Ordering::Relaxed);
        }
        // The oldest keys have labels of their own, so that a label never changes its meaning.
        let (named, rest) = key_requests.split_at(key_requests.len().min(KEYS_NAMED));
        let rest =
            (!rest.is_empty()).then(|| ("other".to_owned(), rest.iter().map(|(_, count)| count).sum()));
        for (key, count) in named.iter().map(|(seq, count)| (seq.public(), *count)).chain(rest) {
            self.by_key.get_or_create(&[("key", key)]).inner().store(count, Ordering::Relaxed);
        }
        let mut out = String::new();
        // Writing to a string does not fail.
        let _ = text::encode_registry(&mut out, &self.registry);
        let _ = text::encode(&mut out, &self.of_this_moment(stats));
        out
    }

    /// Returns the gauges that are read on request.
    fn of_this_moment(&self, stats: &Stats) -> Registry {
        let mut registry = Registry::with_prefix(PREFIX);
        let Process { resident_bytes, open_fds } = Process::now();
        let own = [
            ("resident_memory_bytes", "Resident memory of the process; 0 if unknown", resident_bytes),
            ("open_fds", "Open files and connections of the process; 0 if unknown", open_fds),
            ("uptime_seconds", "Time since the server started", self.started.elapsed().as_secs()),
        ];
        for (name, help, value) in stats.figures.iter().chain(&own) {
            registered::<Gauge<u64, AtomicU64>>(&mut registry, name, help).set(*value);
        }
        let help = "Time spent loading maps into memory since the server started";
        let map_load: Gauge<f64, AtomicU64> = registered(&mut registry, "map_load_seconds", help);
        map_load.set(stats.loads.load_microseconds as f64 / 1e6);
        registry
    }
}

fn known(method: &str) -> &'static str {
    const METHODS: [&str; 7] = ["GET", "HEAD", "PUT", "POST", "PATCH", "DELETE", "OPTIONS"];
    METHODS.into_iter().find(|known| *known == method).unwrap_or("other")
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use crate::domain::verdict::Decision;

    #[test]
    fn requests_verdicts_and_stats_are_told() {
        let metrics = Metrics::default();
        metrics.answered("GET", "/v1/maps/{map}", 404, Duration::from_millis(2));
        metrics.answered("BREW", "unmatched", 405, Duration::ZERO);
        let verdicts = BTreeMap::from([(Decision::Loop, 1)]);
        let figures = vec![("keyframes", "Keyframes of all maps in memory", 7)];
        let stats = Stats { figures, verdicts, ..Stats::default() };
        let requests = |seq| (KeySeq(seq), if seq == 1 { 3 } else { 1 });
        let key_requests: Vec<_> = (1..=KEYS_NAMED as i64 + 2).map(requests).collect();
        let text = metrics.text(&stats, &key_requests);
        for line in [
            r#"revisit_http_requests_total{method="GET",route="/v1/maps/{map}",status="4xx"} 1"#,
            r#"revisit_http_requests_total{method="other",route="unmatched",status="4xx"} 1"#,
            r#"revisit_http_request_seconds_bucket{le="0.0025",method="GET",route="/v1/maps/{map}"} 1"#,
            r#"revisit_loop_verdicts_total{verdict="loop"} 1"#,
            "revisit_keyframes 7",
            r#"revisit_http_refusals_total{status="404"} 1"#,
            r#"revisit_key_requests_total{key="key-1"} 3"#,
            r#"revisit_key_requests_total{key="other"} 2"#,
            r#"revisit_build_info{version=""#,
        ] {
            assert!(text.contains(line), "{line}\n{text}");
        }
    }
}
