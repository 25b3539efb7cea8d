//! Tesseract: a reader of characters on this machine, by its command line, so that a plain machine can read a door plate.

use std::io;
use std::process::Stdio;
use std::sync::Arc;
use std::time::Duration;

use image::imageops::FilterType;
use image::{DynamicImage, GrayImage, ImageFormat, Luma};
use thiserror::Error;
use tokio::io::AsyncWriteExt as _;
use tokio::process::Command;

use super::picture::Picture;
use crate::semantics;

/// The name of its readings.
pub const SOURCE: &str = "tesseract";

const PROGRAM: &str = "tesseract";

/// One plate is read in a few tenths of a second.
const TIME_MAX: Duration = Duration::from_secs(20);

/// Characters are read best at about this height.
const HEIGHT_PX: u32 = 96;

/// White around the text, which the reader expects of a page.
const BORDER_PX: u32 = 16;

/// A reading longer than this is noise.
const CHARS_MAX: usize = 500;

/// Why nothing was read.
#[derive(Debug, Error)]
pub enum ReaderError {
    /// The program is not there, or does not run.
    #[error("tesseract does not run: {0}")]
    Program(#[from] io::Error),
    /// It ended with an error.
    #[error("tesseract failed with {0}")]
    Failed(std::process::ExitStatus),
    /// It took too long.
    #[error("tesseract took longer than {} s", TIME_MAX.as_secs())]
    TimedOut,
    /// The image could not be prepared.
    #[error("the image could not be prepared")]
    Image,
}

/// The reader, found on this machine.
#[derive(Clone, Debug)]
pub struct Tesseract {
    /// As it names itself.
    pub version: String,
}

impl Tesseract {
    /// Looks for the program.
    pub async fn find() -> Result<Self, ReaderError> {
        let output = Command::new(PROGRAM).arg("--version").stdin(Stdio::null()).output().await?;
        if !output.status.success() {
            return Err(ReaderError::Failed(output.status));
        }
        // Some releases write it to standard error.
        let said = if output.stdout.is_empty() { output.stderr } else { output.stdout };
        let version = String::from_utf8_lossy(&said).lines().next().unwrap_or_default().to_owned();
        Ok(Self { version })
    }

    /// Reads one line of characters; empty if there is none.
    pub async fn read(&self, picture: Arc<Picture>) -> Result<String, ReaderError> {
        let prepared = tokio::task::spawn_blocking(move || prepare(&picture));
        let page = prepared.await.map_err(|_| ReaderError::Image)?.ok_or(ReaderError::Image)?;
        // One line, by the neural engine; the image goes in and the text comes out without a file.
        let mut child = Command::new(PROGRAM)
            .args(["stdin", "stdout", "--psm", "7", "--oem", "1"])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .kill_on_drop(true)
            .spawn()?;
        let mut stdin = child.stdin.take();
        let exchange = async {
            if let Some(stdin) = &mut stdin {
                // It may have seen enough and hung up: its status tells.
                let _ = stdin.write_all(&page).await;
            }
            drop(stdin);
            child.wait_with_output().await
        };
        let output = tokio::time::timeout(TIME_MAX, exchange).await.map_err(|_| ReaderError::TimedOut)??;
        if !output.status.success() {
            return Err(ReaderError::Failed(output.status));
        }
        let text = semantics::clean(&String::from_utf8_lossy(&output.stdout));
        Ok(text.chars().take(CHARS_MAX).collect())
    }
}

/// Dark characters on white, of a fixed height, with a border, split by Otsu's threshold.
fn prepare(picture: &Picture) -> Option<Vec<u8>> {
    let grey = image::load_from_memory_with_format(&picture.png, ImageFormat::Png).ok()?.to_luma8();
    let width = (u64::from(grey.width()) * u64::from(HEIGHT_PX) / u64::from(grey.height().max(1))).max(1);
    let width = u32::try_from(width).ok()?.min(8 * 1024);
    let grey = image::imageops::resize(&grey, width, HEIGHT_PX, FilterType::CatmullRom);
    let threshold = otsu(&grey);
    let dark = grey.pixels().filter(|pixel| pixel.0[0] <= threshold).count();
    // Characters cover less than their ground: what covers more is the ground.
    let inverted = 2 * dark > (width * HEIGHT_PX) as usize;
    let mut page = GrayImage::from_pixel(width + 2 * BORDER_PX, HEIGHT_PX + 2 * BORDER_PX, Luma([255]));
    for (x, y, pixel) in grey.enumerate_pixels() {
        let is_ink = (pixel.0[0] <= threshold) != inverted;
        page.put_pixel(x + BORDER_PX, y + BORDER_PX, Luma([if is_ink { 0 } else { 255 }]));
    }
    let mut png = Vec::new();
    DynamicImage::ImageLuma8(page).write_to(&mut io::Cursor::new(&mut png), ImageFormat::Png).ok()?;
    Some(png)
}

/// The threshold that parts an image's greys into the two tightest groups (Otsu 1979).
fn otsu(grey: &GrayImage) -> u8 {
    let mut counts = [0u64; 256];
    for pixel in grey.pixels() {
        counts[usize::from(pixel.0[0])] += 1;
    }
    let total: u64 = counts.iter().sum();
    let sum: u64 = counts.iter().enumerate().map(|(level, count)| level as u64 * count).sum();
    let (mut below, mut sum_below) = (0u64, 0u64);
    let mut best = (0.0, 127);
    for (level, count) in counts.iter().enumerate() {
        below += count;
        sum_below += level as u64 * count;
        if below == 0 || below == total {
            continue;
        }
        let above = total - below;
        let difference = sum_below as f64 / below as f64 - (sum - sum_below) as f64 / above as f64;
        let between = below as f64 * above as f64 * difference * difference;
        if between > best.0 {
            best = (between, level as u8);
        }
    }
    best.1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_characters_on_a_dark_plate_become_dark_on_white() {
        let mut plate = image::RgbImage::from_pixel(40, 20, image::Rgb([30, 30, 90]));
        for y in 5..15 {
            plate.put_pixel(20, y, image::Rgb([240, 240, 240]));
            plate.put_pixel(21, y, image::Rgb([240, 240, 240]));
        }
        let mut file = Vec::new();
        let plate = DynamicImage::ImageRgb8(plate);
        plate.write_to(&mut io::Cursor::new(&mut file), ImageFormat::Png).expect("an image");
        let page = prepare(&Picture::decode(&file).expect("an image")).expect("a page");
        let page = image::load_from_memory(&page).expect("an image").to_luma8();
        assert_eq!(page.height(), HEIGHT_PX + 2 * BORDER_PX);
        let ink = page.pixels().filter(|pixel| pixel.0[0] == 0).count();
        assert!(ink > 0 && 4 * ink < page.pixels().len(), "{ink} pixels of ink");
        assert_eq!(page.get_pixel(0, 0).0[0], 255);
    }
}
