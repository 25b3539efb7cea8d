//! A tour of the hotel, written as a recording.

use std::fs::File;
use std::io::Write as _;
use std::path::Path;

use serde_json::Value;

use super::arguments::HotelArgs;
use crate::cli::compressed_file::{CompressedFile, ZSTD_LEVEL};
use crate::cli::failure::Failure;
use crate::hotel::building::texture::Patterns;
use crate::hotel::recording::recording;
use crate::hotel::scenario::Scenario;
use crate::hotel::scoring::paper::FIGURE_6;
use crate::hotel::sensing::noise::NoiseKind;

/// Writes the tour that the arguments name.
pub(super) fn run(args: &HotelArgs, file: &Path) -> Result<(), Failure> {
    let patterns = Patterns::new();
    let (name, scenario) = if let Some(seed) = args.world {
        let kind = args.kinds().first().copied().unwrap_or(NoiseKind::None);
        (format!("hotel-{}-{seed}", kind.as_str()), Scenario::random(seed, kind, &patterns))
    } else {
        (String::from("hotel"), Scenario::of_paper(&FIGURE_6, &patterns))
    };
    write(file, recording(&name, &scenario.course, &patterns.vocabulary()?)?)
}

/// Writes the lines of a recording into a file, compressed according to its name.
pub(super) fn write(file: &Path, lines: Vec<Value>) -> Result<(), Failure> {
    let mut out = CompressedFile::new(File::create(file)?, file, ZSTD_LEVEL)?;
    for line in lines {
        writeln!(out, "{line}")?;
    }
    out.finish()?;
    Ok(())
}
