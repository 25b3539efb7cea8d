//! Anchors: searched, read, described by hand and removed.

use bytes::Bytes;
use reqwest::Method;
use revisit_api::anchor::{AnchorPatchBody, AnchorView};
use revisit_api::list::AnchorList;
use revisit_api::map::MapVersion;
use revisit_api::names::AnchorStateName;
use revisit_api::prior::PriorBody;
use revisit_api::transcript::TranscriptList;

use super::connection::Client;
use super::error::ClientError;
use super::maps::Page;
use super::operation::operations;

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

operations! {
    /// Reads an anchor.
    read anchor(map, anchor) ["v1", "maps", map, "anchors", anchor] AnchorView;
    /// Reads the last dialogues with models about an anchor.
    read transcript(map, anchor) ["v1", "maps", map, "anchors", anchor, "transcript"] TranscriptList;
    /// Describes an anchor by hand, whatever its version.
    patch patch_anchor(map, anchor) ["v1", "maps", map, "anchors", anchor] AnchorPatchBody, AnchorView;
    /// Puts a prior anchor: a sign that a plan shows.
    put put_prior_anchor(map, anchor) ["v1", "maps", map, "anchors", anchor] PriorBody, AnchorView;
    /// Removes an anchor.
    remove delete_anchor(map, anchor) ["v1", "maps", map, "anchors", anchor] MapVersion;
}

impl Client {
    /// Lists anchors, oldest first.
    pub async fn list_anchors(&self, map: &str, search: &AnchorSearch) -> Result<AnchorList, ClientError> {
        self.read(&["v1", "maps", map, "anchors"], &search.parameters()).await
    }

    /// Reads the image of an anchor, a PNG or JPEG file.
    pub async fn crop(&self, map: &str, anchor: &str) -> Result<Bytes, ClientError> {
        let path = ["v1", "maps", map, "anchors", anchor, "crop"];
        Ok(self.ask(Method::GET, &path, &[]).await?.bytes())
    }
}
