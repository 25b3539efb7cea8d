//! Stats: figures for the metrics page. They are read while everything else is stuck, so nothing here waits for a lock
//! that a request holds while it works, and nothing asks the database.

use std::sync::atomic::Ordering;

use crate::engine::lock::lock;
use crate::engine::maps::features::FeatureFigures;
use crate::engine::maps::loads::LoadFigures;
use crate::engine::{Service, VerdictCounts};
use crate::store::files::paths::{DatabaseFiles, FileSizes};
use crate::store::{CommitStats, Disk, Leases};

/// Figures for the metrics page.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Stats {
    /// Maps in memory.
    pub maps: u64,
    /// Bytes that these maps take, about.
    pub map_memory_bytes: u64,
    /// Bytes that they may take.
    pub map_memory_limit_bytes: u64,
    /// Loads and evictions of maps.
    pub loads: LoadFigures,
    /// Keyframes of these maps.
    pub keyframes: u64,
    /// Anchors of these maps, merged ones counted once.
    pub anchors: u64,
    /// Postings of their inverted files.
    pub postings: u64,
    /// Bytes of their inverted files.
    pub index_bytes: u64,
    /// Writes to the disk.
    pub commits: CommitStats,
    /// Writes that are being decided, or wait for the disk.
    pub writes_under_way: u64,
    /// Writes that wait for their turn to be decided.
    pub writes_waiting: u64,
    /// Heavy reads that compute.
    pub reads_under_way: u64,
    /// Heavy reads that wait for their turn.
    pub reads_waiting: u64,
    /// Keyframes to be asked about because of what models have found.
    pub triggers_waiting: u64,
    /// Loop checks that anchors have triggered and that are not done.
    pub triggers_under_way: u64,
    /// Loop queries answered since the start, by verdict.
    pub verdicts: VerdictCounts,
    /// The cache of features.
    pub feature_cache: FeatureFigures,
    /// The size of the database.
    pub files: FileSizes,
    /// 1 while the disk is full, so that it refuses writes.
    pub disk_full: u64,
    /// 1 while the disk or the database fails.
    pub disk_failing: u64,
    /// Bytes that the disk of the database has left; 0 if that is not known.
    pub disk_free_bytes: u64,
    /// When the newest backup was taken, by POST /v1/backups or `revisit backup`, in seconds since 1970; 0 without any.
    pub newest_backup_s: u64,
    /// Questions that models are to be asked.
    pub model_jobs: u64,
    /// Questions that models could not answer since the start.
    pub model_failures: u64,
    /// 1 while a model is away or the day's budget is spent.
    pub models_away: u64,
    /// Calls of models since the database was made.
    pub model_calls: u64,
    /// Questions answered without a call.
    pub model_cache_hits: u64,
    /// Servers that share the database; 0 where one alone has it.
    pub nodes: u64,
    /// Maps that this server owns among others.
    pub leases: u64,
    /// Maps that another server took while this one had them.
    pub leases_lost: u64,
    /// Copies of maps that other servers own.
    pub followed_maps: u64,
    /// Versions that copies took over.
    pub followed_versions: u64,
    /// Copies that were loaded anew, as the log did not tell enough.
    pub followed_loads: u64,
    /// Seconds since every copy was up to date; 0 without copies.
    pub follower_lag_s: u64,
    /// What models cost, in millionths of a US dollar.
    pub model_microusd: u64,
}

impl Service {
    /// Figures for the metrics page, of the maps in memory.
    pub fn stats(&self) -> Stats {
        let memory = &self.registry.memory;
        let mut stats = Stats {
            map_memory_bytes: memory.used(),
            map_memory_limit_bytes: memory.budget(),
            loads: *lock(&self.registry.loads.figures),
            model_jobs: self.worker.open_jobs.load(Ordering::Relaxed),
            model_failures: self.models.as_ref().map_or(0, |models| models.failures()),
            models_away: self.models.as_ref().map_or(0, |models| u64::from(models.is_away())),
            commits: self.store.committer().stats(),
            writes_under_way: self.writes.inside() as u64,
            writes_waiting: self.writes.waiting() as u64,
            reads_under_way: self.reads.inside() as u64,
            reads_waiting: self.reads.waiting() as u64,
            triggers_waiting: self.triggers.waiting(),
            triggers_under_way: self.triggers.under_way(),
            verdicts: *lock(&self.verdicts),
            feature_cache: self.features.figures(),
            files: self.store.files().map(DatabaseFiles::sizes).unwrap_or_default(),
            disk_full: u64::from(self.disk() == Disk::Full),
            disk_failing: u64::from(self.disk() == Disk::Failing),
            disk_free_bytes: self.store.files().and_then(DatabaseFiles::free_bytes).unwrap_or(0),
            newest_backup_s: self.newest_backup_s(),
            nodes: self.node_count(),
            leases: self.store.leases().map_or(0, Leases::count),
            leases_lost: self.store.leases().map_or(0, Leases::lost),
            followed_maps: self.followers.count(),
            followed_versions: self.followers.versions.load(Ordering::Relaxed),
            followed_loads: self.followers.loaded_anew.load(Ordering::Relaxed),
            follower_lag_s: self.followers.lag_s(),
            ..Stats::default()
        };
        for line in self.usage().into_iter().flat_map(|usage| usage.lines) {
            stats.model_calls += line.calls;
            stats.model_cache_hits += line.cache_hits;
            stats.model_microusd += line.microusd;
        }
        self.registry.each_in_memory(|live| {
            let figures = live.figures();
            stats.maps += 1;
            stats.keyframes += figures.keyframes;
            stats.anchors += figures.anchors;
            stats.postings += figures.postings;
            stats.index_bytes += figures.index_bytes;
        });
        stats
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
        assert_eq!((told.maps, told.writes_under_way), (1, 1));
        assert!(told.files.wal > 0);
        service.close().await;
    }
}
