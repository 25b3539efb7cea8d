//! Standard output.

use std::io::{self, Write as _};

/// Writes to standard output. A closed pipe (`revisit openapi | head`) is not an error.
pub(in crate::cli) fn write_out(text: &str) -> io::Result<()> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        other => other,
    }
}
