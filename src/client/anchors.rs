//! Anchors: searched, read, described by hand and removed.

use bytes::Bytes;
use reqwest::Method;

use super::body::Body;
use super::connection::{Client, Written};
use super::error::ClientError;
use super::maps::{Page, borrowed};
use crate::api::anchor::{AnchorPatchBody, AnchorView};
use crate::api::list::AnchorList;
use crate::api::map::MapVersion;
use crate::api::names::AnchorStateName;
use crate::api::prior::PriorBody;
use crate::api::transcript::TranscriptList;

/// The anchors to be listed.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct AnchorSearch {
    /// Only anchors of this class.
    pub class: Option<String>,
    /// Only anchors whose description has these words.
    pub text: Option<String>,
    /// Only anchors in this state.
    pub state: Option<AnchorStateName>,
    /// Also anchors that were merged into others.
    pub merged: bool,
    /// Only prior anchors, or only those that robots saw.
    pub prior: Option<bool>,
    /// The part of the list.
    pub page: Page,
}

impl AnchorSearch {
    fn parameters(&self) -> Vec<(&'static str, String)> {
        let named = [
            ("class", self.class.clone()),
            ("text", self.text.clone()),
            ("state", self.state.map(|state| state.0.as_str().to_owned())),
            ("merged", self.merged.then(|| "true".to_owned())),
            ("prior", self.prior.map(|prior| prior.to_string())),
        ];
        let given = named.into_iter().filter_map(|(name, value)| Some((name, value?)));
        given.chain(self.page.parameters()).collect()
    }
}

impl Client {
    /// Lists anchors, oldest first.
    pub async fn list_anchors(&self, map: &str, search: &AnchorSearch) -> Result<AnchorList, ClientError> {
        self.read(&["v1", "maps", map, "anchors"], &borrowed(&search.parameters())).await
    }

    /// Reads an anchor.
    pub async fn anchor(&self, map: &str, anchor: &str) -> Result<AnchorView, ClientError> {
        self.read(&["v1", "maps", map, "anchors", anchor], &[]).await
    }

    /// Reads the last dialogues with models about an anchor.
    pub async fn transcript(&self, map: &str, anchor: &str) -> Result<TranscriptList, ClientError> {
        self.read(&["v1", "maps", map, "anchors", anchor, "transcript"], &[]).await
    }

    /// Reads the image of an anchor, a PNG or JPEG file.
    pub async fn crop(&self, map: &str, anchor: &str) -> Result<Bytes, ClientError> {
        let path = ["v1", "maps", map, "anchors", anchor, "crop"];
        Ok(self.send(Method::GET, &path, &[], None::<&()>).await?.bytes())
    }

    /// Describes an anchor by hand, whatever its version.
    pub async fn patch_anchor(
        &self,
        map: &str,
        anchor: &str,
        body: &impl Body<AnchorPatchBody>,
    ) -> Result<AnchorView, ClientError> {
        Ok(self.write(Method::PATCH, &["v1", "maps", map, "anchors", anchor], &[], body).await?.answer)
    }

    /// Puts a prior anchor: a sign that a plan shows.
    pub async fn put_prior_anchor(
        &self,
        map: &str,
        anchor: &str,
        body: &impl Body<PriorBody>,
    ) -> Result<Written<AnchorView>, ClientError> {
        self.write(Method::PUT, &["v1", "maps", map, "anchors", anchor], &[], body).await
    }

    /// Removes an anchor.
    pub async fn delete_anchor(&self, map: &str, anchor: &str) -> Result<MapVersion, ClientError> {
        self.remove(&["v1", "maps", map, "anchors", anchor], &[]).await?.decode()
    }
}
