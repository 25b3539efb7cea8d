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

/// Makes the rows of gauges: of each the name, the figure that it reads, and its description.
macro_rules! gauges {
    ($($name:literal = $($figure:ident).+, $help:literal;)+) => {
        &[$(($name, $help, |of| of.$($figure).+)),+]
    };
}

/// Every gauge.
pub const GAUGES: &[Row] = gauges! {
    "maps" = stats.maps, "Maps in memory";
    "map_memory_bytes" = stats.map_memory_bytes, "Estimated bytes of the maps in memory";
    "map_memory_limit_bytes" = stats.map_memory_limit_bytes, "Bytes of maps above which idle ones are evicted (--map-memory)";
    "map_loads" = stats.loads.loads, "Maps loaded into memory since the server started";
    "map_loads_oversized" = stats.loads.oversized, "Loads of maps that are larger than --map-memory";
    "map_evictions" = stats.loads.evictions, "Idle maps evicted from memory since the server started";
    "nodes" = stats.nodes, "Servers that share the database; 0 where one alone has it";
    "leases" = stats.leases, "Maps that this server owns among others";
    "leases_lost" = stats.leases_lost, "Maps that another server took while this one had them";
    "followed_maps" = stats.followed_maps, "Copies of maps that other servers own";
    "followed_versions" = stats.followed_versions, "Versions that copies took over from their owners' log";
    "followed_loads" = stats.followed_loads, "Copies that were loaded anew, because the log did not tell enough";
    "map_promotions" = stats.loads.promoted, "Copies that became this server's own maps, without being loaded again";
    "follower_lag_seconds" = stats.follower_lag_s, "Time since every copy was last up to date; 0 without copies";
    "keyframes" = stats.keyframes, "Keyframes of all maps in memory";
    "anchors" = stats.anchors, "Semantic anchors of all maps in memory";
    "postings" = stats.postings, "Postings of the inverted files";
    "index_bytes" = stats.index_bytes, "Bytes of the inverted files in memory";
    "commits" = stats.commits.jobs, "Writes committed since the server started";
    "commit_batches" = stats.commits.transactions, "Transactions of these commits; fewer than commits under load";
    "queue_depth" = stats.commits.waiting, "Writes waiting for their commit";
    "writes_under_way" = stats.writes_under_way, "Writes being decided or waiting for their commit";
    "writes_waiting" = stats.writes_waiting, "Writes waiting to be decided";
    "reads_under_way" = stats.reads_under_way, "Heavy reads and verifications in progress";
    "reads_waiting" = stats.reads_waiting, "Heavy reads and verifications waiting for a permit";
    "triggers_waiting" = stats.triggers_waiting, "Keyframes waiting for a loop check after a model's description";
    "triggers_under_way" = stats.triggers_under_way, "Loop checks in progress that anchors have triggered";
    "feature_cache_hits" = stats.feature_cache.hits, "Features that geometry found in memory";
    "feature_cache_misses" = stats.feature_cache.misses, "Features that geometry read from disk";
    "feature_cache_bytes" = stats.feature_cache.bytes, "Bytes of the features in memory";
    "database_bytes" = stats.files.database, "Bytes of the database on disk";
    "wal_bytes" = stats.files.wal, "Bytes of its write-ahead log on disk";
    "disk_full" = stats.disk_full, "1 while the disk is full, so that writes are refused";
    "disk_failing" = stats.disk_failing, "1 while the disk or the database fails";
    "disk_free_bytes" = stats.disk_free_bytes, "Bytes left on the disk of the database; 0 if unknown";
    "newest_backup_seconds" = stats.newest_backup_s, "Unix time of the newest backup by POST /v1/backups or revisit backup; 0 without any";
    "model_jobs" = stats.model_jobs, "Questions waiting for a model";
    "model_calls" = stats.model_calls, "Model calls since the database was created";
    "model_cache_hits" = stats.model_cache_hits, "Questions answered without a call";
    "model_failures" = stats.model_failures, "Questions that models could not answer";
    "model_microusd" = stats.model_microusd, "Cost of models, in millionths of a US dollar";
    "models_away" = stats.models_away, "1 while a model is unavailable or the budget is spent";
    "resident_memory_bytes" = process.resident_bytes, "Resident memory of the process; 0 if unknown";
    "open_fds" = process.open_fds, "Open files and connections of the process; 0 if unknown";
    "uptime_seconds" = uptime_s, "Time since the server started";
};
