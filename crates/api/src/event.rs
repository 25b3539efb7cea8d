//! Event: what happened in a map, as the stream tells it.

use revisit_core::domain::event::Event;
use revisit_shapes::answer;

use super::names::EventName;
use super::space::Time;

/// One event: the `data` of a server-sent event whose `id` is `seq`. It is flat; what a kind does not speak of is left out.
#[answer(of = Event)]
#[schema(as = Event)]
pub struct EventView {
    /// Its number in its map, growing by one.
    pub seq: u64,
    /// The kind of event.
    #[from(of.kind)]
    pub event: EventName,
    /// The map's version in which it happened.
    pub map_version: u64,
    /// When it happened, by the server's clock.
    #[from(of.told)]
    pub time: Option<Time>,
    /// The anchor it is about; of two that merged, the one whose name both go by.
    pub anchor: Option<String>,
    /// The other anchor.
    pub other: Option<String>,
    /// The keyframe that came back.
    pub keyframe: Option<String>,
    /// The keyframe it came back to.
    pub candidate: Option<String>,
    /// The loop it is about.
    #[serde(rename = "loop")]
    pub loop_id: Option<String>,
    /// The loop query that found it.
    pub query: Option<String>,
    /// The session that merged into another one.
    pub session: Option<String>,
    /// The session that it merged into.
    pub into: Option<String>,
    /// The description, or one sentence for a person.
    pub detail: Option<String>,
}
