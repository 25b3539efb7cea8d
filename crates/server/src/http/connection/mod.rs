//! Connections: limiting, timing out and rejecting them. [`super::server`] accepts them.

use std::task::Poll;

use axum::body::Bytes;
use hyper::body::Frame;

pub mod answer_memory;
pub mod bound_answers;
pub mod connection_limit;
pub mod io_timeout;
pub mod min_rate_body;
pub mod protocol_errors;
pub mod reject_connection;
pub mod sockets;
pub mod unread;

/// The result of polling a body.
type PolledFrame<E> = Poll<Option<Result<Frame<Bytes>, E>>>;
