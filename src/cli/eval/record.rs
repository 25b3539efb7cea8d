//! A tour of the hotel, written as a recording.

use std::path::Path;

use super::arguments::HotelArgs;
use super::files;
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
    files::write_recording(file, recording(&name, &scenario.course, &patterns.vocabulary()?)?)
}
