//! Failure of a subcommand.

use std::error::Error;

/// The reason why a subcommand failed, in text for a person.
pub type Failure = Box<dyn Error + Send + Sync>;
