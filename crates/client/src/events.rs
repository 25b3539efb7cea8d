//! Events: a map's server-sent events, one after the other.

use std::ops::ControlFlow;
use std::time::Duration;

use revisit_api::event::EventView;

use super::connection::{Client, decode};
use super::error::ClientError;

/// A stream is listened to for at most this long; then the caller listens again from the last number.
const LISTEN_TIMEOUT: Duration = Duration::from_hours(12);

impl Client {
    /// Listens to a map's events above `since`, until `take` breaks or the server ends the stream.
    pub async fn listen(
        &self,
        map: &str,
        since: u64,
        mut take: impl FnMut(EventView) -> ControlFlow<()>,
    ) -> Result<(), ClientError> {
        let path = ["v1", "maps", map, "events"];
        let mut received = Vec::new();
        self.pieces(&path, &[("since", since.to_string())], LISTEN_TIMEOUT, |url, piece| {
            received.extend_from_slice(piece);
            while let Some(end) = received.windows(2).position(|two| two == b"\n\n") {
                let event: Vec<u8> = received.drain(..end + 2).collect();
                // Comments keep the stream alive; an event is one line of data beside its number and its name.
                let data = event.split(|byte| *byte == b'\n').find_map(|line| line.strip_prefix(b"data:"));
                let Some(data) = data else { continue };
                if take(decode(url, data)?).is_break() {
                    return Ok(ControlFlow::Break(()));
                }
            }
            Ok(ControlFlow::Continue(()))
        })
        .await
    }
}
