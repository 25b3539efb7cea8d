//! Operations: one function per operation of the API, the body as the API document has it.

use std::io;
use std::time::Duration;

use reqwest::Method;
use serde_json::Value;

use super::{
    Answer, Client, ClientError, ClosedLoop, KeyframeAnswer, LoopAnswer, MapAnswer, StoredKeyframe, address,
};

/// A map of a million keyframes is exported within this time.
const EXPORT_TIMEOUT: Duration = Duration::from_hours(12);

impl Client {
    /// Declares a map: `{"description", "metric", "anchor_classes", "settings"}`.
    pub async fn put_map(&self, map: &str, body: &Value) -> Result<MapAnswer, ClientError> {
        let url = self.map_url(map, &[], &[])?;
        let answer = self.send(Method::PUT, url, Some(body)).await?;
        Ok(MapAnswer { replayed: answer.replayed, ..answer.decode()? })
    }

    /// Changes what it names of a map: `{"description", "metric", "anchor_classes", "settings"}`.
    pub async fn patch_map(&self, map: &str, body: &Value) -> Result<MapAnswer, ClientError> {
        let url = self.map_url(map, &[], &[])?;
        self.send(Method::PATCH, url, Some(body)).await?.decode()
    }

    /// Removes a map with all that is in it.
    pub async fn delete_map(&self, map: &str) -> Result<(), ClientError> {
        let url = self.map_url(map, &[], &[])?;
        self.send(Method::DELETE, url, None).await.map(drop)
    }

    /// Stores a keyframe, and asks the loop query in the same round trip if `ask_loop`.
    pub async fn put_keyframe(
        &self,
        map: &str,
        keyframe: &str,
        body: &Value,
        ask_loop: bool,
    ) -> Result<KeyframeAnswer, ClientError> {
        let query: &[(&str, &str)] = if ask_loop { &[("query", "loop")] } else { &[] };
        let url = self.map_url(map, &["keyframes", keyframe], query)?;
        let answer = self.send(Method::PUT, url, Some(body)).await?;
        Ok(KeyframeAnswer { replayed: answer.replayed, ..answer.decode()? })
    }

    /// Removes a keyframe; what hangs on it follows.
    pub async fn delete_keyframe(&self, map: &str, keyframe: &str) -> Result<(), ClientError> {
        let url = self.map_url(map, &["keyframes", keyframe], &[])?;
        self.send(Method::DELETE, url, None).await.map(drop)
    }

    /// The anchor that a detection feeds: anchors are named by the server, detections by who sent them.
    pub async fn anchor_of(
        &self,
        map: &str,
        keyframe: &str,
        detection: usize,
    ) -> Result<String, ClientError> {
        let url = self.map_url(map, &["keyframes", keyframe], &[])?;
        let stored: StoredKeyframe = self.send(Method::GET, url, None).await?.decode()?;
        let named = stored.detections.into_iter().nth(detection).and_then(|detection| detection.anchor);
        named.ok_or_else(|| ClientError::NoAnchor { keyframe: keyframe.to_owned(), detection })
    }

    /// Describes an anchor by hand, whatever version it has: `{"description": text or null}`.
    pub async fn patch_anchor(&self, map: &str, anchor: &str, body: &Value) -> Result<(), ClientError> {
        let url = self.map_url(map, &["anchors", anchor], &[])?;
        self.send(Method::PATCH, url, Some(body)).await.map(drop)
    }

    /// Removes an anchor.
    pub async fn delete_anchor(&self, map: &str, anchor: &str) -> Result<(), ClientError> {
        let url = self.map_url(map, &["anchors", anchor], &[])?;
        self.send(Method::DELETE, url, None).await.map(drop)
    }

    /// "Is this keyframe a loop?": `{"keyframe" | "inline", "verify", "max_wait_ms", "seed"}`.
    pub async fn loop_query(&self, map: &str, body: &Value) -> Result<LoopAnswer, ClientError> {
        let url = self.map_url(map, &["loop-queries"], &[])?;
        self.send(Method::POST, url, Some(body)).await?.decode()
    }

    /// A loop that the client closed: `{"id", "keyframe", "candidate", "query"}`.
    pub async fn post_loop(&self, map: &str, body: &Value) -> Result<ClosedLoop, ClientError> {
        let url = self.map_url(map, &["loops"], &[])?;
        self.send(Method::POST, url, Some(body)).await?.decode()
    }

    /// Revokes a loop; what it merged is split again.
    pub async fn delete_loop(&self, map: &str, id: &str) -> Result<(), ClientError> {
        let url = self.map_url(map, &["loops", id], &[])?;
        self.send(Method::DELETE, url, None).await.map(drop)
    }

    /// Poses and map points after the client's optimisation: `{"session", "keyframes", "map_points"}`.
    pub async fn post_poses(&self, map: &str, body: &Value) -> Result<(), ClientError> {
        let url = self.map_url(map, &["poses"], &[])?;
        self.send(Method::POST, url, Some(body)).await.map(drop)
    }

    /// Brings a verdict of a model: `{"operation", "class", "texts", "level", ...}`.
    pub async fn post_model_verdict(&self, map: &str, body: &Value) -> Result<(), ClientError> {
        let url = self.map_url(map, &["model-verdicts"], &[])?;
        self.send(Method::POST, url, Some(body)).await.map(drop)
    }

    /// Reads a map as a recording, which `take` is given piece by piece.
    pub async fn export(
        &self,
        map: &str,
        mut take: impl FnMut(&[u8]) -> io::Result<()>,
    ) -> Result<(), ClientError> {
        let url = self.map_url(map, &["export"], &[])?;
        let failed = |source| ClientError::transport(&url, source);
        let request = self.request(Method::GET, &url, None).timeout(EXPORT_TIMEOUT);
        let mut response = request.send().await.map_err(failed)?;
        if !response.status().is_success() {
            return Answer::read(url, response).await.map(drop);
        }
        while let Some(piece) = response.chunk().await.map_err(failed)? {
            take(&piece).map_err(ClientError::Write)?;
        }
        Ok(())
    }

    fn map_url(&self, map: &str, below: &[&str], query: &[(&str, &str)]) -> Result<String, ClientError> {
        let path = [&["v1", "maps", map], below].concat();
        address::url(self.base_url(), &path, query)
    }
}
