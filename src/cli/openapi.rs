//! `revisit openapi`: prints the API document.

use clap::{Args, ValueEnum};

use super::failure::Failure;
use super::output::write_out;
use crate::http::document;

/// Print the API document (OpenAPI 3.1).
///
/// A running server serves it at /openapi.json.
#[derive(Args, Debug)]
pub struct OpenapiArgs {
    /// The output format
    #[arg(long, env = "REVISIT_FORMAT", value_enum, default_value_t = Format::Yaml)]
    format: Format,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Format {
    Yaml,
    Json,
}

/// Runs `openapi`.
pub fn run(args: &OpenapiArgs) -> Result<(), Failure> {
    let document = document();
    let text = match args.format {
        Format::Yaml => document.to_yaml()?,
        Format::Json => document.to_pretty_json()? + "\n",
    };
    Ok(write_out(&text)?)
}
