//! Gauges: figures of `/metrics` that are read on request, each a row of one table.

use super::process::Process;
use crate::engine::Stats;

/// What the gauges are read from.
#[derive(Clone, Copy, Debug, Default)]
pub struct Figures {
    /// The service's.
    pub stats: Stats,
    /// The process's.
    pub process: Process,
    /// How long the server runs, in seconds.
    pub uptime_s: u64,
}

/// A gauge's name, without the prefix; what it is; and where it is read.
type Row = (&'static str, &'static str, fn(&Figures) -> u64);

/// Every gauge.
pub const GAUGES: &[Row] = &[
    ("maps", "Maps in memory", |f| f.stats.maps),
    ("map_memory_bytes", "Bytes that the maps in memory take, estimated", |f| f.stats.map_memory_bytes),
    ("map_memory_limit_bytes", "Bytes that they may take before idle ones are evicted (--map-memory)", |f| {
        f.stats.map_memory_limit_bytes
    }),
    ("map_loads", "Maps loaded into memory since the server started", |f| f.stats.map_loads),
    ("map_loads_oversized", "Loads of maps that are larger than --map-memory", |f| {
        f.stats.map_loads_oversized
    }),
    ("map_evictions", "Idle maps evicted from memory since the server started", |f| f.stats.map_evictions),
    ("keyframes", "Keyframes of all maps in memory", |f| f.stats.keyframes),
    ("anchors", "Semantic anchors of all maps in memory", |f| f.stats.anchors),
    ("postings", "Postings of the inverted files", |f| f.stats.postings),
    ("index_bytes", "Bytes that the inverted files take in memory", |f| f.stats.index_bytes),
    ("commits", "Writes committed since the server started", |f| f.stats.commits),
    ("commit_batches", "Transactions that carried them; fewer than commits under load", |f| {
        f.stats.commit_batches
    }),
    ("queue_depth", "Writes that wait for their commit", |f| f.stats.queue_depth),
    ("writes_under_way", "Writes that are decided or wait for their commit", |f| f.stats.writes_under_way),
    ("writes_waiting", "Writes that wait for their turn to be decided", |f| f.stats.writes_waiting),
    ("reads_under_way", "Heavy reads and verifications that compute", |f| f.stats.reads_under_way),
    ("reads_waiting", "Heavy reads and verifications that wait for their turn", |f| f.stats.reads_waiting),
    ("triggers_waiting", "Keyframes that models have found to be worth asking about", |f| {
        f.stats.triggers_waiting
    }),
    ("triggers_under_way", "Loop checks that anchors have triggered", |f| f.stats.triggers_under_way),
    ("feature_cache_hits", "Features that geometry found in memory", |f| f.stats.feature_cache_hits),
    ("feature_cache_misses", "Features that geometry read from disk", |f| f.stats.feature_cache_misses),
    ("feature_cache_bytes", "Bytes of the features in memory", |f| f.stats.feature_cache_bytes),
    ("database_bytes", "Bytes of the database on disk", |f| f.stats.database_bytes),
    ("wal_bytes", "Bytes of its write-ahead log on disk", |f| f.stats.wal_bytes),
    (
        "newest_backup_seconds",
        "When POST /v1/backups took the newest backup, since 1970; 0 without any",
        |f| f.stats.newest_backup_s,
    ),
    ("model_jobs", "Questions that models are to be asked", |f| f.stats.model_jobs),
    ("model_calls", "Calls of models since the database was made", |f| f.stats.model_calls),
    ("model_cache_hits", "Questions answered without a call", |f| f.stats.model_cache_hits),
    ("model_failures", "Questions that models could not answer", |f| f.stats.model_failures),
    ("model_microusd", "What models cost, in millionths of a US dollar", |f| f.stats.model_microusd),
    ("models_away", "1 while a model is away or the budget is spent", |f| f.stats.models_away),
    ("resident_memory_bytes", "Bytes of memory that the process holds; 0 where it cannot be told", |f| {
        f.process.resident_bytes
    }),
    ("open_fds", "Files and connections that the process has open; 0 where it cannot be told", |f| {
        f.process.open_fds
    }),
    ("uptime_seconds", "How long the server runs", |f| f.uptime_s),
];
