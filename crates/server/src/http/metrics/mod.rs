//! Metrics in the text format of Prometheus.

pub mod counters;
pub mod process;
