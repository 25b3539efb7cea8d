//! A tour of the hotel, written as a recording.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;

use flate2::Compression;
use flate2::write::GzEncoder;

use super::arguments::HotelArgs;
use crate::cli::failure::Failure;
use crate::hotel::building::texture::Patterns;
use crate::hotel::recording::recording;
use crate::hotel::scenario::Scenario;
use crate::hotel::scoring::paper::SEQUENCES;
use crate::hotel::sensing::noise::NoiseKind;

/// The sequence of the paper's Figure 6, which the demo runs as well.
const SEQUENCE: &str = "SE2 00";
/// The default level of zstd.
const ZSTD_LEVEL: i32 = 3;

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
    let out = BufWriter::new(File::create(file)?);
    match file.extension().and_then(|extension| extension.to_str()) {
        Some("gz") => write(GzEncoder::new(out, Compression::default()), &lines)?.finish()?.flush()?,
        Some("zst") => write(zstd::Encoder::new(out, ZSTD_LEVEL)?, &lines)?.finish()?.flush()?,
        _ => write(out, &lines)?.flush()?,
    }
    Ok(())
}

fn write<W: Write>(mut out: W, lines: &[serde_json::Value]) -> std::io::Result<W> {
    for line in lines {
        writeln!(out, "{line}")?;
    }
    Ok(out)
}
