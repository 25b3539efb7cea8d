//! A tour of the hotel, written as a recording.

use std::fs::File;
use std::io::Write as _;
use std::path::Path;

use super::arguments::HotelArgs;
use crate::cli::compressed_file::{CompressedFile, ZSTD_LEVEL};
use crate::cli::failure::Failure;
use crate::hotel::building::texture::Patterns;
use crate::hotel::recording::recording;
use crate::hotel::scenario::Scenario;
use crate::hotel::scoring::paper::SEQUENCES;
use crate::hotel::sensing::noise::NoiseKind;

/// The sequence of the paper's Figure 6, which the demo runs as well.
const SEQUENCE: &str = "SE2 00";

/// Writes the tour that the arguments name.
pub(super) fn run(args: &HotelArgs, file: &Path) -> Result<(), Failure> {
    let patterns = Patterns::new();
    let (name, scenario) = if let Some(seed) = args.world {
        let kind = args.kinds().first().copied().unwrap_or(NoiseKind::None);
        (format!("hotel-{}-{seed}", kind.name()), Scenario::random(seed, kind, &patterns))
    } else {
        let printed = SEQUENCES.into_iter().find(|printed| printed.name() == SEQUENCE);
        (String::from("hotel"), Scenario::of_paper(&printed.unwrap_or(SEQUENCES[0]), &patterns))
    };
    let lines = recording(&name, &scenario.course, &patterns.vocabulary()?)?;
    let mut out = CompressedFile::new(File::create(file)?, file, ZSTD_LEVEL)?;
    for line in lines {
        writeln!(out, "{line}")?;
    }
    out.finish()?;
    Ok(())
}
