//! Maps: declared, changed, read, corrected, exported and removed.

use std::io;
use std::ops::ControlFlow;
use std::time::Duration;

use reqwest::Method;
use revisit_api::frames::FramesView;
use revisit_api::list::{MapList, SessionList};
use revisit_api::map::{MapBody, MapPatchBody, MapView};
use revisit_api::observations::{ObservationsAnswer, ObservationsBody};
use revisit_api::poses::{PosesAnswer, PosesBody};
use revisit_api::session_merge::{MergeBody, MergeRevokedAnswer, SessionsMergedAnswer};

use super::connection::Client;
use super::error::ClientError;
use super::operation::operations;

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

operations! {
    /// Lists the sessions of a map, and their alignments to a plan.
    list list_sessions(map) ["v1", "maps", map, "sessions"] SessionList;
    /// Lists the maps, by id.
    list list_maps() ["v1", "maps"] MapList;
    /// Reads a map's properties and figures.
    read map(map) ["v1", "maps", map] MapView;
    /// Declares a map.
    put put_map(map) ["v1", "maps", map] MapBody, MapView;
    /// Changes the properties that the body names.
    patch patch_map(map) ["v1", "maps", map] MapPatchBody, MapView;
    /// Removes a map with all that is in it.
    remove delete_map(map) ["v1", "maps", map];
    /// Sends poses and map points as the client's optimisation corrected them.
    send post_poses(map) ["v1", "maps", map, "poses"] PosesBody, PosesAnswer;
    /// Sends what the client's map did to points and edges after it had sent the keyframes.
    send post_observations(map) ["v1", "maps", map, "observations"] ObservationsBody, ObservationsAnswer;
    /// Merges a session into another one.
    send merge_sessions(map, session) ["v1", "maps", map, "sessions", session, "merge"] MergeBody, SessionsMergedAnswer;
    /// Takes the merge of a session back.
    remove revoke_merge(map, session) ["v1", "maps", map, "sessions", session, "merge"] MergeRevokedAnswer;
}

impl Client {
    /// Reads where the sessions of a map lie to a reference.
    pub async fn frames(&self, map: &str, reference: Option<&str>) -> Result<FramesView, ClientError> {
        let query: Vec<_> = reference.map(|session| ("reference", session.to_owned())).into_iter().collect();
        self.read(&["v1", "maps", map, "frames"], &query).await
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
        let session = session.map(|session| ("session", session.to_owned()));
        let query: Vec<_> = [("format", format.to_owned())].into_iter().chain(session).collect();
        let path = ["v1", "maps", map, "trajectory"];
        Ok(self.ask(Method::GET, &path, &query).await?.text())
    }
}
