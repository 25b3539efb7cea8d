//! Build: what this binary is.

/// The program's name.
pub const NAME: &str = env!("CARGO_PKG_NAME");
/// The program's version.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");

/// The version of the SQLite that is built in.
pub fn sqlite_version() -> &'static str {
    libsqlite3_sys::SQLITE_VERSION.to_str().unwrap_or("unknown")
}
