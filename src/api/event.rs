//! Event: what happened in a map, as the stream tells it.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::names::EventName;
use super::space::Time;
use crate::domain::event::Event;
use crate::domain::ids::AnchorSeq;

/// One event: the `data` of a server-sent event whose `id` is `seq`. It is flat; what a kind does not speak of is left out.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[schema(as = Event)]
pub struct EventView {
    /// Its number in its map, growing by one.
    pub seq: u64,
    /// The kind of event.
    pub event: EventName,
    /// The map's version in which it happened.
    pub map_version: u64,
    /// When it happened, by the server's clock.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time: Option<Time>,
    /// The anchor it is about; of two that merged, the one whose name both go by.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub anchor: Option<String>,
    /// The other anchor.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub other: Option<String>,
    /// The keyframe that came back.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub keyframe: Option<String>,
    /// The keyframe it came back to.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub candidate: Option<String>,
    /// The loop it is about.
    #[serde(rename = "loop", skip_serializing_if = "Option::is_none")]
    pub loop_id: Option<String>,
    /// The loop query that found it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub query: Option<String>,
    /// The session that merged into another one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub session: Option<String>,
    /// The session that it merged into.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub into: Option<String>,
    /// The description, or one sentence for a person.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub detail: Option<String>,
}

impl From<Event> for EventView {
    fn from(event: Event) -> Self {
        Self {
            seq: event.seq,
            event: event.kind.into(),
            map_version: event.map_version,
            time: event.told.map(Time::from),
            anchor: event.anchor.map(AnchorSeq::public),
            other: event.other.map(AnchorSeq::public),
            keyframe: event.keyframe.map(|id| id.to_string()),
            candidate: event.candidate.map(|id| id.to_string()),
            loop_id: event.loop_id.map(|id| id.to_string()),
            query: event.query,
            session: event.session.map(|id| id.to_string()),
            into: event.into.map(|id| id.to_string()),
            detail: event.detail,
        }
    }
}
