//! Keyframes: written, read and removed.

use reqwest::Method;
use revisit_api::anchor::LocalAnchorMap;
use revisit_api::bulk::BulkLine;
use revisit_api::keyframe::{KeyframeAnswer, KeyframeBody, KeyframeView};
use revisit_api::list::{CovisibleList, KeyframeList};
use revisit_api::map::MapVersion;
use serde::Serialize;

use super::body::Body;
use super::connection::{Client, Written};
use super::error::ClientError;
use super::maps::Page;
use super::operation::operations;

/// A keyframe with its id: a line of a bulk request.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NamedKeyframe {
    /// Its id.
    pub id: String,
    /// The keyframe.
    #[serde(flatten)]
    pub keyframe: KeyframeBody,
}

operations! {
    /// Lists the keyframes, in order of arrival.
    list list_keyframes(map) ["v1", "maps", map, "keyframes"] KeyframeList;
    /// Reads a keyframe as it stands now.
    read keyframe(map, keyframe) ["v1", "maps", map, "keyframes", keyframe] KeyframeView;
    /// Removes a keyframe, and everything that rests on it alone.
    remove delete_keyframe(map, keyframe) ["v1", "maps", map, "keyframes", keyframe] MapVersion;
    /// Lists the keyframes that are covisible with one.
    read covisible(map, keyframe) ["v1", "maps", map, "keyframes", keyframe, "covisible"] CovisibleList;
    /// Reads the local anchor map around a keyframe.
    read local_anchor_map(map, keyframe) ["v1", "maps", map, "keyframes", keyframe, "local-anchor-map"] LocalAnchorMap;
}

impl Client {
    /// Lists the keyframes that may be deleted when a quota nears.
    pub async fn list_redundant_keyframes(
        &self,
        map: &str,
        page: &Page,
    ) -> Result<KeyframeList, ClientError> {
        let redundant = [("redundant", "true".to_owned())];
        let parameters: Vec<_> = redundant.into_iter().chain(page.parameters()).collect();
        self.read(&["v1", "maps", map, "keyframes"], &parameters).await
    }

    /// Stores a keyframe, and asks the loop query in the same round trip if `ask_loop`.
    pub async fn put_keyframe(
        &self,
        map: &str,
        keyframe: &str,
        body: &impl Body<KeyframeBody>,
        ask_loop: bool,
    ) -> Result<Written<KeyframeAnswer>, ClientError> {
        let query: Vec<_> = ask_loop.then(|| ("query", "loop".to_owned())).into_iter().collect();
        self.write(Method::PUT, &["v1", "maps", map, "keyframes", keyframe], &query, body).await
    }

    /// Stores many keyframes in one request; the answer has one line for each of them.
    pub async fn put_keyframes(
        &self,
        map: &str,
        keyframes: &[NamedKeyframe],
    ) -> Result<Vec<BulkLine>, ClientError> {
        self.write_lines(&["v1", "maps", map, "keyframes"], keyframes).await
    }

    /// Returns the anchor that a detection feeds: the server names anchors, the client its detections.
    pub async fn anchor_of(
        &self,
        map: &str,
        keyframe: &str,
        detection: usize,
    ) -> Result<String, ClientError> {
        let stored = self.keyframe(map, keyframe).await?;
        let named = stored.detections.into_iter().nth(detection).and_then(|detection| detection.anchor);
        named.ok_or_else(|| ClientError::NoAnchor { keyframe: keyframe.to_owned(), detection })
    }
}
