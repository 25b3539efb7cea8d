//! Client: the API over plain HTTP, in the shapes of [`revisit_api`], for every part of this program that talks to a server.
//!
//! | file | concept |
//! |---|---|
//! | `connection` | one request and its answer |
//! | `address` | ids and queries become URLs |
//! | `operation` | the functions that are a path, a body and an answer |
//! | `body` | a request's body: its shape, or one that was recorded |
//! | `maps`, `keyframes`, `anchors`, `loops`, `releases`, `events`, `semantics`, `service` | one function for each operation of the API |
//! | `error` | the reasons for no answer, in one line each |
//! | [`tls`] | HTTP clients, and the one cryptography provider |
//!
//! # Is this keyframe a loop?
//!
//! ```no_run
//! use revisit_api::loop_query::LoopQueryBody;
//! use revisit_client::{Client, ClientError};
//!
//! # async fn ask() -> Result<(), ClientError> {
//! let client = Client::new("http://localhost:7878")?;
//! let asked = LoopQueryBody { keyframe: Some("kf-42".parse().expect("an id")), ..LoopQueryBody::default() };
//! let answer = client.loop_query("hotel", &asked).await?;
//! println!("{}", answer.why);
//! # Ok(())
//! # }
//! ```

mod address;
mod anchors;
mod body;
mod connection;
mod error;
mod events;
mod keyframes;
mod loops;
mod maps;
mod operation;
mod releases;
mod semantics;
mod service;
#[cfg(test)]
mod tests;
pub mod tls;

pub use anchors::AnchorSearch;
pub use body::{Body, Recorded};
pub use connection::{Client, Written};
pub use error::{ClientError, FieldProblem, Problem};
pub use keyframes::NamedKeyframe;
pub use maps::Page;
