//! A temporary server started by this program.

use std::any::Any;

use tempfile::TempDir;

/// A server that runs as long as this value lives.
pub struct OwnServer {
    url: String,
    _running: Box<dyn Any + Send>,
}

impl OwnServer {
    /// Returns the server at `url`; dropping `running` stops it and removes its database.
    pub fn new(url: impl Into<String>, running: impl Send + 'static) -> Self {
        Self { url: url.into(), _running: Box::new(running) }
    }

    /// Keeps a temporary folder until the server has stopped.
    pub fn with(self, folder: TempDir) -> Self {
        let Self { url, _running: running } = self;
        // Dropped in this order.
        Self { url, _running: Box::new((running, folder)) }
    }

    /// Returns the address on which it listens.
    pub fn url(&self) -> &str {
        &self.url
    }
}
