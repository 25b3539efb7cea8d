//! Why a subcommand failed.

use std::error::Error;

/// Why a subcommand failed, for a person.
pub type Failure = Box<dyn Error + Send + Sync>;
