//! Load-shedding metrics: rejected requests and connections, and those in flight.

use std::sync::atomic::AtomicU64;

use prometheus_client::metrics::counter::Counter;
use prometheus_client::metrics::family::Family;
use prometheus_client::metrics::gauge::Gauge;
use prometheus_client::registry::Registry;

/// A label by itself: its name and its value.
pub(super) type Label<V> = [(&'static str, V); 1];

/// The counters of connections and of shed requests.
#[derive(Debug, Default)]
pub struct ShedMetrics {
    open_connections: Gauge<u64, AtomicU64>,
    in_flight: Gauge<u64, AtomicU64>,
    connections: Family<Label<&'static str>, Counter>,
    shed: Family<Label<&'static str>, Counter>,
}

impl ShedMetrics {
    /// Registers the metrics.
    pub fn register(&self, registry: &mut Registry) {
        registry.register("connections_open", "Connections open", self.open_connections.clone());
        registry.register("requests_in_flight", "Requests in flight", self.in_flight.clone());
        registry.register(
            "connections",
            "Connections accepted, refused without a free slot, or evicted for another",
            self.connections.clone(),
        );
        registry.register("shed", "Requests rejected with 503 at once, by kind", self.shed.clone());
    }

    /// Sets the gauges.
    pub fn now(&self, open_connections: usize, in_flight: usize) {
        self.open_connections.set(open_connections as u64);
        self.in_flight.set(in_flight as u64);
    }

    /// Counts a connection that was `accepted`, `refused` or `evicted`.
    pub fn connection(&self, fate: &'static str) {
        self.connections.get_or_create(&[("fate", fate)]).inc();
    }

    /// Counts a shed `read`, `write`, large `body` or large `answer`.
    pub fn shed(&self, what: &'static str) {
        self.shed.get_or_create(&[("what", what)]).inc();
    }
}
