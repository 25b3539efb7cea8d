//! Service: the server's state, its backups and its keys.

use reqwest::Method;

use super::body::Body;
use super::connection::{Client, Written};
use super::error::ClientError;
use super::maps::{Page, borrowed};
use crate::api::backup::{BackupBody, BackupView};
use crate::api::key::{KeyBody, KeyView};
use crate::api::list::{BackupList, KeyList};
use crate::api::service::{Health, Version};

impl Client {
    /// Reads whether the server is ready.
    pub async fn readyz(&self) -> Result<Health, ClientError> {
        self.read(&["readyz"], &[]).await
    }

    /// Reads whether the process is alive.
    pub async fn healthz(&self) -> Result<Health, ClientError> {
        self.read(&["healthz"], &[]).await
    }

    /// Reads the metrics, in the text format of Prometheus.
    pub async fn metrics(&self) -> Result<String, ClientError> {
        Ok(self.send(Method::GET, &["metrics"], &[], None::<&()>).await?.text())
    }

    /// Reads the server's version.
    pub async fn version(&self) -> Result<Version, ClientError> {
        self.read(&["version"], &[]).await
    }

    /// Takes a backup.
    pub async fn post_backup(
        &self,
        body: &impl Body<BackupBody>,
    ) -> Result<Written<BackupView>, ClientError> {
        self.write(Method::POST, &["v1", "backups"], &[], body).await
    }

    /// Lists the backups, the newest first.
    pub async fn list_backups(&self, page: &Page) -> Result<BackupList, ClientError> {
        self.read(&["v1", "backups"], &borrowed(&page.parameters())).await
    }

    /// Makes a key; the answer alone shows its secret.
    pub async fn post_key(&self, body: &impl Body<KeyBody>) -> Result<KeyView, ClientError> {
        Ok(self.write(Method::POST, &["v1", "keys"], &[], body).await?.answer)
    }

    /// Lists the keys.
    pub async fn list_keys(&self, page: &Page) -> Result<KeyList, ClientError> {
        self.read(&["v1", "keys"], &borrowed(&page.parameters())).await
    }

    /// Revokes a key; the last one of an administrator only if `last_admin`.
    pub async fn delete_key(&self, id: &str, last_admin: bool) -> Result<(), ClientError> {
        let query: &[(&str, &str)] = if last_admin { &[("last_admin", "true")] } else { &[] };
        self.remove(&["v1", "keys", id], query).await.map(drop)
    }
}
