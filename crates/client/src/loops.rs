//! Loops: asked about, confirmed, listed and revoked.

use reqwest::Method;
use revisit_api::list::{LoopList, VerdictList};
use revisit_api::location::{LocateAnswerView, LocateBody};
use revisit_api::loop_query::LoopQueryBody;
use revisit_api::loops::{LoopBody, LoopClosed, LoopRevoked};
use revisit_api::verdict::LoopAnswer;
use revisit_core::domain::request::Detail;

use super::body::Body;
use super::connection::Client;
use super::error::ClientError;
use super::maps::Page;
use super::operation::operations;

operations! {
    /// Asks "is this keyframe a loop?".
    send loop_query(map) ["v1", "maps", map, "loop-queries"] LoopQueryBody, LoopAnswer;
    /// Asks "where am I?".
    send locate() ["v1", "locate"] LocateBody, LocateAnswerView;
    /// Reads an earlier answer.
    read loop_answer(map, query) ["v1", "maps", map, "loop-queries", query] LoopAnswer;
    /// Lists the confirmed loops, oldest first.
    list list_loops(map) ["v1", "maps", map, "loops"] LoopList;
    /// Confirms a loop that the client closed.
    post post_loop(map) ["v1", "maps", map, "loops"] LoopBody, LoopClosed;
    /// Revokes a loop; the anchors that it merged are split again.
    remove delete_loop(map, id) ["v1", "maps", map, "loops", id] LoopRevoked;
}

impl Client {
    /// Asks the same for the verdict alone: the answer lists no rejected candidate, and no matches of the others.
    pub async fn brief_loop_query(
        &self,
        map: &str,
        body: &impl Body<LoopQueryBody>,
    ) -> Result<LoopAnswer, ClientError> {
        let query = [("detail", Detail::Brief.as_str().to_owned())];
        Ok(self.write(Method::POST, &["v1", "maps", map, "loop-queries"], &query, body).await?.answer)
    }

    /// Lists verdicts, the newest first: those that agree with the parameters of `GET .../loop-queries`.
    pub async fn list_loop_queries(
        &self,
        map: &str,
        filter: &[(&str, &str)],
        page: &Page,
    ) -> Result<VerdictList, ClientError> {
        let filter = filter.iter().map(|(name, value)| (*name, (*value).to_owned()));
        let parameters: Vec<_> = filter.chain(page.parameters()).collect();
        self.read(&["v1", "maps", map, "loop-queries"], &parameters).await
    }
}
