//! Loops: asked about, confirmed, listed and revoked.

use reqwest::Method;

use super::body::Body;
use super::connection::{Client, Written};
use super::error::ClientError;
use super::maps::{Page, borrowed};
use crate::api::list::{LoopList, VerdictList};
use crate::api::location::{LocateAnswerView, LocateBody};
use crate::api::loop_query::LoopQueryBody;
use crate::api::loops::{LoopBody, LoopClosed, LoopRevoked};
use crate::api::verdict::LoopAnswer;
use crate::domain::request::Detail;

impl Client {
    /// Asks "is this keyframe a loop?".
    pub async fn loop_query(
        &self,
        map: &str,
        body: &impl Body<LoopQueryBody>,
    ) -> Result<LoopAnswer, ClientError> {
        Ok(self.write(Method::POST, &["v1", "maps", map, "loop-queries"], &[], body).await?.answer)
    }

    /// Asks the same for the verdict alone: the answer lists no rejected candidate, and no matches of the others.
    pub async fn brief_loop_query(
        &self,
        map: &str,
        body: &impl Body<LoopQueryBody>,
    ) -> Result<LoopAnswer, ClientError> {
        let query = [("detail", Detail::Brief.as_str())];
        Ok(self.write(Method::POST, &["v1", "maps", map, "loop-queries"], &query, body).await?.answer)
    }

    /// Asks "where am I?".
    pub async fn locate(&self, body: &impl Body<LocateBody>) -> Result<LocateAnswerView, ClientError> {
        Ok(self.write(Method::POST, &["v1", "locate"], &[], body).await?.answer)
    }

    /// Reads an earlier answer.
    pub async fn loop_answer(&self, map: &str, query: &str) -> Result<LoopAnswer, ClientError> {
        self.read(&["v1", "maps", map, "loop-queries", query], &[]).await
    }

    /// Lists verdicts, the newest first: those that agree with the parameters of `GET .../loop-queries`.
    pub async fn list_loop_queries(
        &self,
        map: &str,
        filter: &[(&str, &str)],
        page: &Page,
    ) -> Result<VerdictList, ClientError> {
        let page = page.parameters();
        let parameters: Vec<_> = filter.iter().copied().chain(borrowed(&page)).collect();
        self.read(&["v1", "maps", map, "loop-queries"], &parameters).await
    }

    /// Lists the confirmed loops, oldest first.
    pub async fn list_loops(&self, map: &str, page: &Page) -> Result<LoopList, ClientError> {
        self.read(&["v1", "maps", map, "loops"], &borrowed(&page.parameters())).await
    }

    /// Confirms a loop that the client closed.
    pub async fn post_loop(
        &self,
        map: &str,
        body: &impl Body<LoopBody>,
    ) -> Result<Written<LoopClosed>, ClientError> {
        self.write(Method::POST, &["v1", "maps", map, "loops"], &[], body).await
    }

    /// Revokes a loop; the anchors that it merged are split again.
    pub async fn delete_loop(&self, map: &str, id: &str) -> Result<LoopRevoked, ClientError> {
        self.remove(&["v1", "maps", map, "loops", id], &[]).await?.decode()
    }
}
