//! Wire: the API's JSON, and plain functions to and from the model.
//!
//! Requests are read by an accumulating [reader](decoding::read), so that a client learns every fault at once; the structs of
//! requests serve the API document and our own client, and a test holds the two together.
//!
//! | file | concept |
//! |---|---|
//! | [`decoding::syntax`], [`decoding::document`] | bytes become a flat list of values |
//! | [`decoding::read`], [`decoding::column`], `faults` | values become the model, each fault with its place |
//! | [`limits`] | how much one request may bring |
//! | [`space`], [`decoding::base64`] | vectors, poses, times; bytes inside JSON |
//! | [`map`], [`settings`], [`keyframe`], [`bulk`], [`poses`], [`observations`], [`anchor`], [`prior`], [`session`], [`session_merge`], [`frames`], [`release`], [`erasure`], [`transcript`], [`loops`], [`event`] | resources |
//! | [`names`], [`words`] | the model's named values, with their meanings; the same for the viewer |
//! | [`loop_query`], [`verdict`], [`geometry`] | "is this keyframe a loop?" and its answer |
//! | `answers` | figures of an answer that several readers need |
//! | [`location`] | "where am I?" and its answer |
//! | [`semantics`], [`usage`], [`service`], [`backup`] | the three functions of §IV-A.2; what models cost; how the server is; copies of it |
//! | [`trajectory`], [`recording`] | poses as TUM, KITTI and g2o write them; a map as a recording |
//! | [`judgement`], [`model_verdict`] | a changed model asked again; what a model said elsewhere |
//! | [`key`] | API keys |
//! | [`list`], [`problem`] | parts of lists; refusals |
//! | [`examples`] | one example of each, for the API document |
//!
//! # All faults of a body at once
//!
//! ```
//! use revisit_api::decoding::{read, syntax};
//! use revisit_api::semantics::TextPair;
//!
//! let sent = br#"{"a": "Room 901", "b": 910, "colour": "red"}"#;
//! let document = syntax::parse(sent).expect("JSON");
//! let faults = read::decode::<TextPair>(&document).err().expect("two faults");
//! let mut places: Vec<&str> = faults.iter().map(|fault| fault.pointer.as_str()).collect();
//! places.sort_unstable();
//! assert_eq!(places, ["/b", "/colour"]);
//! ```

// Shapes, wherever they are declared, name what they need by this crate's name.
extern crate self as revisit_api;

pub mod anchor;
mod answers;
pub mod backup;
pub mod bulk;
pub mod decoding;
pub mod erasure;
pub mod event;
pub mod examples;
pub mod frames;
pub mod geometry;
pub mod judgement;
pub mod key;
pub mod keyframe;
pub mod limits;
pub mod list;
pub mod listed_verdict;
pub mod location;
pub mod loop_query;
pub mod loops;
pub mod map;
pub mod model_verdict;
pub mod names;
pub mod observations;
pub mod odds;
pub mod poses;
pub mod prior;
pub mod problem;
pub mod recording;
pub mod release;
pub mod semantics;
pub mod service;
pub mod session;
pub mod session_merge;
pub mod settings;
pub mod shown;
pub mod space;
pub mod trajectory;
pub mod transcript;
pub mod usage;
pub mod verdict;
pub mod words;

#[cfg(test)]
mod tests;
