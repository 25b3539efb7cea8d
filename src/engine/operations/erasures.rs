//! Erasures: asked for, and read. [`crate::engine::erasures`] does them.

use std::collections::BTreeMap;

use crate::domain::erasure::{Erasure, MergedInVersion, NewErasure, with_merged};
use crate::domain::ids::{BackupId, MapId, SessionId};
use crate::domain::invalid::FieldError;
use crate::engine::error::refuse;
use crate::engine::keys::keyring::now;
use crate::engine::{Result, Service, ServiceError};
use crate::store::{ErasureStep, Job, MapKey};

impl Service {
    /// Asks for an erasure, which begins at once in the background. What is asked for is on disk when this returns.
    pub async fn erase(&self, map: &MapId, asked: NewErasure) -> Result<Erasure> {
        let _owned = self.own(map).await?;
        let key = self.key_of(map).await?;
        let asked = match asked {
            NewErasure::Sessions(sessions) => {
                NewErasure::Sessions(self.whole_sessions(key, &sessions).await?)
            }
            keyframes @ NewErasure::Keyframes(_) => keyframes,
        };
        let number = {
            let _asking = self.asking.lock().await;
            let number = self.store.next_erasure(key).await?;
            let job = Job::Erase(key, number, ErasureStep::Begin(asked, now()));
            self.store.committer().commit(job).await?;
            number
        };
        tracing::info!(%map, number, "an erasure was asked for");
        self.erase_in_background();
        self.erasure_of(map, key, number).await
    }

    /// Returns sessions with all that merged into them in any version of the map. Refuses those that are a part of another one in any:
    /// there they cannot be told from it. Refuses the frame of a plan, too.
    async fn whole_sessions(&self, map: MapKey, sessions: &[SessionId]) -> Result<Vec<SessionId>> {
        let merges = self.store.merges_of_versions(map).await?;
        let all = with_merged(sessions, &merges);
        let mut faults = BTreeMap::new();
        for MergedInVersion { release, session, into } in &merges {
            let Some(at) = all.get(session).filter(|_| !all.contains_key(into)) else { continue };
            let (place, cure) = match release {
                None => (String::from("by now"), ""),
                Some(release) => (format!("in release {release}"), ", or delete the release"),
            };
            let detail = format!("session {session} is a part of session {into} {place}");
            let fault = FieldError::new(format!("/sessions/{at}"), detail).got(&sessions[*at]);
            let limit = format!("{into}, which is erased with what merged into it{cure}");
            faults.entry(*at).or_insert_with(|| fault.limit(limit));
        }
        for (release, session) in self.store.frames_of_plans(map).await? {
            let Some(at) = all.get(&session) else { continue };
            let place = release.map_or_else(String::new, |release| format!(" in release {release}"));
            let detail = format!("prior anchors{place} have their places in the frame of session {session}");
            let fault = FieldError::new(format!("/sessions/{at}"), detail).got(&sessions[*at]);
            let limit =
                "a session without prior anchors: delete these, and the release that has some, before";
            faults.entry(*at).or_insert_with(|| fault.limit(limit));
        }
        refuse(faults.into_values().collect())?;
        Ok(all.into_keys().cloned().collect())
    }

    /// Returns an erasure, and the backups that were taken before it was done: they still hold what it erased.
    pub async fn erasure(&self, map: &MapId, number: u64) -> Result<(Erasure, Vec<BackupId>)> {
        let erasure = self.erasure_of(map, self.key_of(map).await?, number).await?;
        let backups = self.backups.as_ref().map(|folder| folder.list()).transpose()?.unwrap_or_default();
        let is_older = |created| erasure.ended.is_none_or(|ended| created <= ended);
        let older = backups.into_iter().filter(|backup| is_older(backup.created)).map(|backup| backup.id);
        let older = older.collect();
        Ok((erasure, older))
    }

    async fn erasure_of(&self, map: &MapId, key: MapKey, number: u64) -> Result<Erasure> {
        let found = self.store.erasure(key, number).await?;
        found.ok_or_else(|| ServiceError::NotFound(format!("there is no erasure e-{number} of map {map}")))
    }
}
