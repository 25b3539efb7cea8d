//! Maps: declared, changed, read, corrected, exported and removed.

use std::io;
use std::ops::ControlFlow;
use std::time::Duration;

use reqwest::Method;

use super::body::Body;
use super::connection::{Client, Written};
use super::error::ClientError;
use crate::api::frames::FramesView;
use crate::api::list::{MapList, SessionList};
use crate::api::map::{MapBody, MapPatchBody, MapView};
use crate::api::observations::{ObservationsAnswer, ObservationsBody};
use crate::api::poses::{PosesAnswer, PosesBody};
use crate::api::session_merge::{MergeBody, MergeRevokedAnswer, SessionsMergedAnswer};

/// A map of a million keyframes is exported within this time.
const EXPORT_TIMEOUT: Duration = Duration::from_hours(12);

/// A part of a list.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Page {
    /// The number of items at most.
    pub limit: Option<usize>,
    /// `next_cursor` of the part before.
    pub cursor: Option<String>,
}

impl Page {
    /// Returns the parameters of a request.
    pub(super) fn parameters(&self) -> Vec<(&'static str, String)> {
        let limit = self.limit.map(|limit| ("limit", limit.to_string()));
        let cursor = self.cursor.clone().map(|cursor| ("cursor", cursor));
        limit.into_iter().chain(cursor).collect()
    }
}

/// Borrows parameters as a request takes them.
pub(super) fn borrowed<'a>(parameters: &'a [(&'static str, String)]) -> Vec<(&'static str, &'a str)> {
    parameters.iter().map(|(name, value)| (*name, value.as_str())).collect()
}

impl Client {
    /// Lists the sessions of a map, and their alignments to a plan.
    pub async fn list_sessions(&self, map: &str, page: &Page) -> Result<SessionList, ClientError> {
        self.read(&["v1", "maps", map, "sessions"], &borrowed(&page.parameters())).await
    }

    /// Reads where the sessions of a map lie to a reference.
    pub async fn frames(&self, map: &str, reference: Option<&str>) -> Result<FramesView, ClientError> {
        let query: Vec<(&str, &str)> = reference.map(|session| ("reference", session)).into_iter().collect();
        self.read(&["v1", "maps", map, "frames"], &query).await
    }

    /// Lists the maps, by id.
    pub async fn list_maps(&self, page: &Page) -> Result<MapList, ClientError> {
        self.read(&["v1", "maps"], &borrowed(&page.parameters())).await
    }

    /// Reads a map's properties and figures.
    pub async fn map(&self, map: &str) -> Result<MapView, ClientError> {
        self.read(&["v1", "maps", map], &[]).await
    }

    /// Declares a map.
    pub async fn put_map(
        &self,
        map: &str,
        body: &impl Body<MapBody>,
    ) -> Result<Written<MapView>, ClientError> {
        self.write(Method::PUT, &["v1", "maps", map], &[], body).await
    }

    /// Changes the properties that the body names.
    pub async fn patch_map(&self, map: &str, body: &impl Body<MapPatchBody>) -> Result<MapView, ClientError> {
        Ok(self.write(Method::PATCH, &["v1", "maps", map], &[], body).await?.answer)
    }

    /// Removes a map with all that is in it.
    pub async fn delete_map(&self, map: &str) -> Result<(), ClientError> {
        self.remove(&["v1", "maps", map], &[]).await.map(drop)
    }

    /// Sends poses and map points as the client's optimisation corrected them.
    pub async fn post_poses(
        &self,
        map: &str,
        body: &impl Body<PosesBody>,
    ) -> Result<PosesAnswer, ClientError> {
        Ok(self.write(Method::POST, &["v1", "maps", map, "poses"], &[], body).await?.answer)
    }

    /// Sends what the client's map did to points and edges after it had sent the keyframes.
    pub async fn post_observations(
        &self,
        map: &str,
        body: &impl Body<ObservationsBody>,
    ) -> Result<ObservationsAnswer, ClientError> {
        Ok(self.write(Method::POST, &["v1", "maps", map, "observations"], &[], body).await?.answer)
    }

    /// Merges a session into another one.
    pub async fn merge_sessions(
        &self,
        map: &str,
        session: &str,
        body: &impl Body<MergeBody>,
    ) -> Result<SessionsMergedAnswer, ClientError> {
        let path = ["v1", "maps", map, "sessions", session, "merge"];
        Ok(self.write(Method::POST, &path, &[], body).await?.answer)
    }

    /// Takes the merge of a session back.
    pub async fn revoke_merge(&self, map: &str, session: &str) -> Result<MergeRevokedAnswer, ClientError> {
        self.remove(&["v1", "maps", map, "sessions", session, "merge"], &[]).await?.decode()
    }

    /// Reads a map as a recording; `take` receives it piece by piece.
    pub async fn export(
        &self,
        map: &str,
        mut take: impl FnMut(&[u8]) -> io::Result<()>,
    ) -> Result<(), ClientError> {
        let path = ["v1", "maps", map, "export"];
        let take = |_: &str, piece: &[u8]| take(piece).map(ControlFlow::Continue).map_err(ClientError::Write);
        self.pieces(&path, &[], EXPORT_TIMEOUT, take).await
    }

    /// Reads the trajectory in a format (`tum`, `kitti` or `g2o`), of one session where the format takes one only.
    pub async fn trajectory(
        &self,
        map: &str,
        format: &str,
        session: Option<&str>,
    ) -> Result<String, ClientError> {
        let query: Vec<(&str, &str)> =
            [("format", format)].into_iter().chain(session.map(|session| ("session", session))).collect();
        let path = ["v1", "maps", map, "trajectory"];
        Ok(self.send(Method::GET, &path, &query, None::<&()>).await?.text())
    }
}
