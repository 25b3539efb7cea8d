//! Releases: published, listed, compared and deleted; and what is erased for good.

use reqwest::Method;

use super::body::Body;
use super::connection::{Client, Written};
use super::error::ClientError;
use super::maps::{Page, borrowed};
use crate::api::erasure::{ErasureBody, ErasureView};
use crate::api::list::ReleaseList;
use crate::api::release::{ReleaseBody, ReleaseChangesView, ReleaseView};

impl Client {
    /// Lists the releases of a map, by name.
    pub async fn list_releases(&self, map: &str, page: &Page) -> Result<ReleaseList, ClientError> {
        self.read(&["v1", "maps", map, "releases"], &borrowed(&page.parameters())).await
    }

    /// Publishes the map as it stands.
    pub async fn publish_release(
        &self,
        map: &str,
        release: &str,
        body: &impl Body<ReleaseBody>,
    ) -> Result<Written<ReleaseView>, ClientError> {
        self.write(Method::PUT, &["v1", "maps", map, "releases", release], &[], body).await
    }

    /// Reads a release, and who asked it.
    pub async fn release(&self, map: &str, release: &str) -> Result<ReleaseView, ClientError> {
        self.read(&["v1", "maps", map, "releases", release], &[]).await
    }

    /// Deletes a release.
    pub async fn delete_release(&self, map: &str, release: &str) -> Result<(), ClientError> {
        self.remove(&["v1", "maps", map, "releases", release], &[]).await.map(drop)
    }

    /// Asks for an erasure.
    pub async fn erase(&self, map: &str, body: &impl Body<ErasureBody>) -> Result<ErasureView, ClientError> {
        Ok(self.write(Method::POST, &["v1", "maps", map, "erase"], &[], body).await?.answer)
    }

    /// Reads an erasure.
    pub async fn erasure(&self, map: &str, erasure: &str) -> Result<ErasureView, ClientError> {
        self.read(&["v1", "maps", map, "erase", erasure], &[]).await
    }

    /// Compares a release with a later one, or with the map as it stands.
    pub async fn changes(
        &self,
        map: &str,
        since: &str,
        until: Option<&str>,
    ) -> Result<ReleaseChangesView, ClientError> {
        let until = until.map(|until| ("until", until));
        let query: Vec<(&str, &str)> = [("since", since)].into_iter().chain(until).collect();
        self.read(&["v1", "maps", map, "changes"], &query).await
    }
}
