//! The things the service speaks of. No IO, no JSON, no SQL: those shapes live in `wire` and `store`.
//!
//! | concept | file |
//! |---|---|
//! | ids of clients, dense numbers of maps | [`ids`] |
//! | keyframe, camera, features, detection as sent | [`keyframe`] |
//! | one vector of a whole image | [`global_descriptor`] |
//! | bag-of-words vector and its L1 score | [`bow`] |
//! | observation of an anchor, outcome of a detection | [`anchor`] |
//! | signs known from a plan before a robot saw them | [`prior`] |
//! | map, its settings, and those that make a method | [`map`], [`settings`], [`method`] |
//! | map points in few bytes | [`point_list`], [`varint`] |
//! | facts that decisions change, and the values they replace | [`change`], [`former`] |
//! | what models said of anchors | [`judged`] |
//! | jobs that ask a changed model again | [`judgement`] |
//! | the ways in which candidates are found | [`channel`] |
//! | the answer to "is it a loop?", and the table of its reasons | [`verdict`], [`reason`] |
//! | the line that a list shows of a verdict | [`verdict_line`] |
//! | the answer to "where am I?" | [`location`] |
//! | what happened, for those who listen | [`event`] |
//! | which models a server has | [`roles`] |
//! | what a client asks for | [`request`] |
//! | views for readers | [`report`], [`trajectory`], [`recorded`] |
//! | named versions of a map that stay as they are | [`release`] |
//! | keyframes that leave for good | [`erasure`] |
//! | API keys and what they may do | [`key`] |
//! | what is wrong with a body | [`invalid`] |
//! | a number with its noun | [`mod@counted`] |

pub mod anchor;
pub mod anchor_name;
pub mod bow;
pub mod change;
pub mod channel;
pub mod counted;
pub mod erasure;
pub mod event;
pub mod fleet_frames;
pub mod former;
pub mod global_descriptor;
pub mod ids;
pub mod invalid;
pub mod judge_answer;
pub mod judged;
pub mod judgement;
pub mod key;
pub mod keyframe;
pub mod location;
pub mod look_for;
pub mod loop_warning;
pub mod map;
pub mod method;
pub mod named_detection;
pub mod observation_update;
pub mod point_list;
pub mod prior;
pub mod reason;
pub mod recorded;
pub mod release;
pub mod report;
pub mod request;
pub mod roles;
pub mod session_merge;
mod setting;
pub mod settings;
mod settings_form;
pub mod trajectory;
pub mod varint;
pub mod verdict;
pub mod verdict_line;
