//! Stats: figures for the metrics page. They are read while everything else is stuck, so nothing here waits for a lock
//! that a request holds while it works, and nothing asks the database.

use std::collections::BTreeMap;
use std::sync::atomic::Ordering::Relaxed;

use crate::domain::report::UsageLine;
use crate::domain::verdict::Decision;
use crate::engine::Service;
use crate::engine::lock::lock;
use crate::engine::maps::live::Figures;
use crate::engine::maps::loads::LoadFigures;
use crate::store::files::paths::DatabaseFiles;
use crate::store::{Disk, Leases};

/// A figure: its name, what it is, and its value.
pub type Figure = (&'static str, &'static str, u64);

/// Figures for the metrics page.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Stats {
    /// Those that are numbers of this moment or since the start, in the order of the page.
    pub figures: Vec<Figure>,
    /// Loop queries answered since the start, by verdict.
    pub verdicts: BTreeMap<Decision, u64>,
    /// Loads and evictions of maps.
    pub loads: LoadFigures,
}

/// Makes figures: of each the name, the value, and what it is.
macro_rules! figures {
    ($($name:literal = $value:expr, $what:literal;)+) => {
        vec![$(($name, $what, $value)),+]
    };
}

impl Service {
    /// Figures for the metrics page, of the maps in memory.
    pub fn stats(&self) -> Stats {
        let (memory, followers, models) = (&self.registry.memory, &self.followers, self.models.as_ref());
        let (commits, disk) = (self.store.committer().stats(), self.disk());
        let (leases, files) = (self.store.leases(), self.store.files());
        let free_bytes = files.and_then(DatabaseFiles::free_bytes).unwrap_or(0);
        let files = files.map(DatabaseFiles::sizes).unwrap_or_default();
        let (verdicts, loads) = (lock(&self.verdicts).clone(), *lock(&self.registry.loads.figures));
        let maps = self.registry.figures();
        let of_maps = |figure: fn(&Figures) -> u64| maps.iter().map(figure).sum();
        let usage = self.usage().map_or_else(Vec::new, |usage| usage.lines);
        let of_models = |figure: fn(&UsageLine) -> u64| usage.iter().map(figure).sum();
        let figures = figures! {
            "maps" = of_maps(|_| 1), "Maps in memory";
            "map_memory_bytes" = memory.used(), "Estimated bytes of the maps in memory";
            "map_memory_limit_bytes" = memory.budget(), "Bytes of maps above which idle ones are evicted (--map-memory)";
            "map_loads" = loads.loads, "Maps loaded into memory since the server started";
            "map_loads_oversized" = loads.oversized, "Loads of maps that are larger than --map-memory";
            "map_evictions" = loads.evictions, "Idle maps evicted from memory since the server started";
            "nodes" = self.node_count(), "Servers that share the database; 0 where one alone has it";
            "leases" = leases.map_or(0, Leases::count), "Maps that this server owns among others";
            "leases_lost" = leases.map_or(0, Leases::lost), "Maps that another server took while this one had them";
            "followed_maps" = followers.count(), "Copies of maps that other servers own";
            "followed_versions" = followers.versions.load(Relaxed), "Versions that copies took over from their owners' log";
            "followed_loads" = followers.loaded_anew.load(Relaxed), "Copies that were loaded anew, because the log did not tell enough";
            "map_promotions" = loads.promoted, "Copies that became this server's own maps, without being loaded again";
            "follower_lag_seconds" = followers.lag_s(), "Time since every copy was last up to date; 0 without copies";
            "keyframes" = of_maps(|map| map.keyframes), "Keyframes of all maps in memory";
            "anchors" = of_maps(|map| map.anchors), "Semantic anchors of all maps in memory";
            "postings" = of_maps(|map| map.postings), "Postings of the inverted files";
            "index_bytes" = of_maps(|map| map.index_bytes), "Bytes of the inverted files in memory";
            "commits" = commits.jobs, "Writes committed since the server started";
            "commit_batches" = commits.transactions, "Transactions of these commits; fewer than commits under load";
            "queue_depth" = commits.waiting, "Writes waiting for their commit";
            "writes_under_way" = self.writes.inside() as u64, "Writes being decided or waiting for their commit";
            "writes_waiting" = self.writes.waiting() as u64, "Writes waiting to be decided";
            "reads_under_way" = self.reads.inside() as u64, "Heavy reads and verifications in progress";
            "reads_waiting" = self.reads.waiting() as u64, "Heavy reads and verifications waiting for a permit";
            "triggers_waiting" = self.triggers.waiting(), "Keyframes waiting for a loop check after a model's description";
            "triggers_under_way" = self.triggers.under_way(), "Loop checks in progress that anchors have triggered";
            "feature_cache_hits" = self.features.hits.load(Relaxed), "Features that geometry found in memory";
            "feature_cache_misses" = self.features.misses.load(Relaxed), "Features that geometry read from disk";
            "feature_cache_bytes" = self.features.bytes(), "Bytes of the features in memory";
            "database_bytes" = files.database, "Bytes of the database on disk";
            "wal_bytes" = files.wal, "Bytes of its write-ahead log on disk";
            "disk_full" = u64::from(disk == Disk::Full), "1 while the disk is full, so that writes are refused";
            "disk_failing" = u64::from(disk == Disk::Failing), "1 while the disk or the database fails";
            "disk_free_bytes" = free_bytes, "Bytes left on the disk of the database; 0 if unknown";
            "newest_backup_seconds" = self.newest_backup_s(), "Unix time of the newest backup by POST /v1/backups or revisit backup; 0 without any";
            "model_jobs" = self.worker.open_jobs.load(Relaxed), "Questions waiting for a model";
            "model_calls" = of_models(|line| line.calls), "Model calls since the database was created";
            "model_cache_hits" = of_models(|line| line.cache_hits), "Questions answered without a call";
            "model_failures" = models.map_or(0, |models| models.failures()), "Questions that models could not answer";
            "model_microusd" = of_models(|line| line.microusd), "Cost of models, in millionths of a US dollar";
            "models_away" = models.map_or(0, |models| u64::from(models.is_away())), "1 while a model is unavailable or the budget is spent";
        };
        Stats { figures, verdicts, loads }
    }
}

#[cfg(test)]
mod tests {
    use crate::domain::map::MapProperties;
    use crate::engine::maps::live::Decision;
    use crate::engine::{Service, ServiceOptions};

    #[tokio::test(flavor = "multi_thread")]
    async fn figures_are_told_while_a_request_holds_a_map() {
        let folder = tempfile::tempdir().unwrap();
        let database = format!("sqlite://{}/stats.db", folder.path().display());
        let service = Service::open(ServiceOptions::for_tests(database)).await.unwrap();
        let id = "hotel".parse().unwrap();
        service.put_map(id, MapProperties::default(), None).await.unwrap();
        let live = service.live(&"hotel".parse().unwrap()).await.unwrap();
        // Under the map's lock: if the figures waited for it, this would never end.
        let within = service.clone();
        let told = service.change(&live, move |_| Ok(Decision::Unchanged(within.stats()))).await.unwrap().0;
        let figure = |name| told.figures.iter().find(|figure| figure.0 == name).unwrap().2;
        assert_eq!((figure("maps"), figure("writes_under_way")), (1, 1));
        assert!(figure("wal_bytes") > 0);
        service.close().await;
    }
}
