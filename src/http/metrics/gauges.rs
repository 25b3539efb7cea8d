//! Gauges: figures of `/metrics` that are read on request, each a row of one table.

use super::process::Process;
use crate::domain::key::KeySeq;
use crate::engine::Stats;

/// The sources of the gauges.
#[derive(Clone, Debug, Default)]
pub struct Figures {
    /// The service's.
    pub stats: Stats,
    /// Requests by each good key, the oldest key first.
    pub key_requests: Vec<(KeySeq, u64)>,
    /// The process's.
    pub process: Process,
    /// Time since the server started, in seconds.
    pub uptime_s: u64,
}

/// A gauge: its name without the prefix, its description, and its reader.
type Row = (&'static str, &'static str, fn(&Figures) -> u64);

/// Every gauge.
pub const GAUGES: &[Row] = &[
    ("maps", "Maps in memory", |f| f.stats.maps),
    ("map_memory_bytes", "Estimated bytes of the maps in memory", |f| f.stats.map_memory_bytes),
    ("map_memory_limit_bytes", "Bytes of maps above which idle ones are evicted (--map-memory)", |f| {
        f.stats.map_memory_limit_bytes
    }),
    ("map_loads", "Maps loaded into memory since the server started", |f| f.stats.loads.loads),
    ("map_loads_oversized", "Loads of maps that are larger than --map-memory", |f| f.stats.loads.oversized),
    ("map_evictions", "Idle maps evicted from memory since the server started", |f| f.stats.loads.evictions),
    ("nodes", "Servers that share the database; 0 where one alone has it", |f| f.stats.nodes),
    ("leases", "Maps that this server owns among others", |f| f.stats.leases),
    ("leases_lost", "Maps that another server took while this one had them", |f| f.stats.leases_lost),
    ("followed_maps", "Copies of maps that other servers own", |f| f.stats.followed_maps),
    ("followed_versions", "Versions that copies took over from their owners' log", |f| {
        f.stats.followed_versions
    }),
    ("followed_loads", "Copies that were loaded anew, because the log did not tell enough", |f| {
        f.stats.followed_loads
    }),
    ("map_promotions", "Copies that became this server's own maps, without being loaded again", |f| {
        f.stats.loads.promoted
    }),
    ("follower_lag_seconds", "Time since every copy was last up to date; 0 without copies", |f| {
        f.stats.follower_lag_s
    }),
    ("keyframes", "Keyframes of all maps in memory", |f| f.stats.keyframes),
    ("anchors", "Semantic anchors of all maps in memory", |f| f.stats.anchors),
    ("postings", "Postings of the inverted files", |f| f.stats.postings),
    ("index_bytes", "Bytes of the inverted files in memory", |f| f.stats.index_bytes),
    ("commits", "Writes committed since the server started", |f| f.stats.commits.jobs),
    ("commit_batches", "Transactions of these commits; fewer than commits under load", |f| {
        f.stats.commits.transactions
    }),
    ("queue_depth", "Writes waiting for their commit", |f| f.stats.commits.waiting),
    ("writes_under_way", "Writes being decided or waiting for their commit", |f| f.stats.writes_under_way),
    ("writes_waiting", "Writes waiting to be decided", |f| f.stats.writes_waiting),
    ("reads_under_way", "Heavy reads and verifications in progress", |f| f.stats.reads_under_way),
    ("reads_waiting", "Heavy reads and verifications waiting for a permit", |f| f.stats.reads_waiting),
    ("triggers_waiting", "Keyframes waiting for a loop check after a model's description", |f| {
        f.stats.triggers_waiting
    }),
    ("triggers_under_way", "Loop checks in progress that anchors have triggered", |f| {
        f.stats.triggers_under_way
    }),
    ("feature_cache_hits", "Features that geometry found in memory", |f| f.stats.feature_cache.hits),
    ("feature_cache_misses", "Features that geometry read from disk", |f| f.stats.feature_cache.misses),
    ("feature_cache_bytes", "Bytes of the features in memory", |f| f.stats.feature_cache.bytes),
    ("database_bytes", "Bytes of the database on disk", |f| f.stats.files.database),
    ("wal_bytes", "Bytes of its write-ahead log on disk", |f| f.stats.files.wal),
    ("disk_full", "1 while the disk is full, so that writes are refused", |f| f.stats.disk_full),
    ("disk_failing", "1 while the disk or the database fails", |f| f.stats.disk_failing),
    ("disk_free_bytes", "Bytes left on the disk of the database; 0 if unknown", |f| f.stats.disk_free_bytes),
    (
        "newest_backup_seconds",
        "Unix time of the newest backup by POST /v1/backups or revisit backup; 0 without any",
        |f| f.stats.newest_backup_s,
    ),
    ("model_jobs", "Questions waiting for a model", |f| f.stats.model_jobs),
    ("model_calls", "Model calls since the database was created", |f| f.stats.model_calls),
    ("model_cache_hits", "Questions answered without a call", |f| f.stats.model_cache_hits),
    ("model_failures", "Questions that models could not answer", |f| f.stats.model_failures),
    ("model_microusd", "Cost of models, in millionths of a US dollar", |f| f.stats.model_microusd),
    ("models_away", "1 while a model is unavailable or the budget is spent", |f| f.stats.models_away),
    ("resident_memory_bytes", "Resident memory of the process; 0 if unknown", |f| f.process.resident_bytes),
    ("open_fds", "Open files and connections of the process; 0 if unknown", |f| f.process.open_fds),
    ("uptime_seconds", "Time since the server started", |f| f.uptime_s),
];
