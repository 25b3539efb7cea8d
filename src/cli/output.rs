//! Standard output, and progress on standard error.

use std::io::{self, Write as _};

use indicatif::{ProgressBar, ProgressStyle};

/// Writes to standard output. A closed pipe (`revisit openapi | head`) is not an error.
pub(in crate::cli) fn write_out(text: &str) -> io::Result<()> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        other => other,
    }
}

/// Returns a progress bar on standard error, shown only on a terminal.
pub(in crate::cli) fn progress_bar(what: &'static str) -> ProgressBar {
    let style = ProgressStyle::with_template("{wide_bar} {percent:>3} %  {msg}")
        .unwrap_or_else(|_| ProgressStyle::default_bar());
    ProgressBar::no_length().with_style(style).with_message(what)
}
