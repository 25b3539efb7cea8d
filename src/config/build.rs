//! Build: what this binary is.

/// The program's name.
pub const NAME: &str = env!("CARGO_PKG_NAME");
/// The program's version.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");
