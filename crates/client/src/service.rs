//! Service: the server's state, its backups and its keys.

use reqwest::Method;
use revisit_api::backup::{BackupBody, BackupView};
use revisit_api::key::{KeyBody, KeyView};
use revisit_api::list::{BackupList, KeyList};
use revisit_api::service::{Health, Version};

use super::connection::Client;
use super::error::ClientError;
use super::operation::operations;

operations! {
    /// Reads whether the server is ready.
    read readyz() ["readyz"] Health;
    /// Reads whether the process is alive.
    read healthz() ["healthz"] Health;
    /// Reads the server's version.
    read version() ["version"] Version;
    /// Takes a backup.
    post post_backup() ["v1", "backups"] BackupBody, BackupView;
    /// Lists the backups, the newest first.
    list list_backups() ["v1", "backups"] BackupList;
    /// Makes a key; the answer alone shows its secret.
    send post_key() ["v1", "keys"] KeyBody, KeyView;
    /// Lists the keys.
    list list_keys() ["v1", "keys"] KeyList;
}

impl Client {
    /// Reads the metrics, in the text format of Prometheus.
    pub async fn metrics(&self) -> Result<String, ClientError> {
        Ok(self.ask(Method::GET, &["metrics"], &[]).await?.text())
    }

    /// Revokes a key; the last one of an administrator only if `last_admin`.
    pub async fn delete_key(&self, id: &str, last_admin: bool) -> Result<(), ClientError> {
        let query: Vec<_> = last_admin.then(|| ("last_admin", "true".to_owned())).into_iter().collect();
        self.ask(Method::DELETE, &["v1", "keys", id], &query).await.map(drop)
    }
}
