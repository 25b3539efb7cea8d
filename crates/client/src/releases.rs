//! Releases: published, listed, compared and deleted; and what is erased for good.

use revisit_api::erasure::{ErasureBody, ErasureView};
use revisit_api::list::ReleaseList;
use revisit_api::release::{ReleaseBody, ReleaseChangesView, ReleaseView};

use super::connection::Client;
use super::error::ClientError;
use super::operation::operations;

operations! {
    /// Lists the releases of a map, by name.
    list list_releases(map) ["v1", "maps", map, "releases"] ReleaseList;
    /// Publishes the map as it stands.
    put publish_release(map, release) ["v1", "maps", map, "releases", release] ReleaseBody, ReleaseView;
    /// Reads a release, and who asked it.
    read release(map, release) ["v1", "maps", map, "releases", release] ReleaseView;
    /// Deletes a release.
    remove delete_release(map, release) ["v1", "maps", map, "releases", release];
    /// Asks for an erasure.
    send erase(map) ["v1", "maps", map, "erase"] ErasureBody, ErasureView;
    /// Reads an erasure.
    read erasure(map, erasure) ["v1", "maps", map, "erase", erasure] ErasureView;
}

impl Client {
    /// Compares a release with a later one, or with the map as it stands.
    pub async fn changes(
        &self,
        map: &str,
        since: &str,
        until: Option<&str>,
    ) -> Result<ReleaseChangesView, ClientError> {
        let until = until.map(|until| ("until", until.to_owned()));
        let query: Vec<_> = [("since", since.to_owned())].into_iter().chain(until).collect();
        self.read(&["v1", "maps", map, "changes"], &query).await
    }
}
