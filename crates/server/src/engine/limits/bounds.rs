//! Bounds on what the engine works on at once.

/// Maximum writes that are decided or wait for the disk at once. Further ones wait.
pub(in crate::engine) const WRITES_AT_ONCE: usize = 512;

/// Maximum reads (loop queries, lists), and as many decisions of writes, that compute at once, for each core. More would only
/// share it, and delay short requests. One tenant has half of them: all cores, while nobody else asks.
pub(in crate::engine) const TURNS_PER_CORE: usize = 2;

/// Maximum requests that wait for one of these. The limit on requests bounds them first, unless the operator or many cores
/// allow more.
pub(in crate::engine) const WAITING_MAX: usize = 1024;

/// Maximum exports, releases and copies at once: each keeps one of the store's readers, an export for as long as its client takes.
pub(in crate::engine) const EXPORTS_AT_ONCE: usize = 4;
