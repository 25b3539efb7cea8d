//! Answering: the service that answers a reading request, from a map or from a copy of one that another server owns.

use std::convert::Infallible;

use axum::extract::FromRequestParts;
use axum::http::request::Parts;

use crate::engine::Service;
use crate::http::App;

/// A mark on requests that a copy answers.
#[derive(Clone, Copy, Debug)]
pub struct FromCopy;

/// The service that answers a request which reads.
pub struct Answering(pub Service);

impl FromRequestParts<App> for Answering {
    type Rejection = Infallible;

    async fn from_request_parts(parts: &mut Parts, app: &App) -> Result<Self, Infallible> {
        let is_from_copy = parts.extensions.get::<FromCopy>().is_some();
        Ok(Self(if is_from_copy { app.following.clone() } else { app.service.clone() }))
    }
}
