//! OCR: simulates how ordinary text recognition reads a sign, calibrated on the recording `floors`.
//!
//! The calibration uses the 265 readings of its plates ("7.04"; the digits of the true floor are known) and all of its
//! 1,281 readings, from 1,056 photographs:
//!
//! | measure | in `floors` | here |
//! |---|---|---|
//! | height of the letters | none of the plates below 10 px, 14 from 10 to 14, 74 from 14 to 18 | nothing below 10 px, half of them up to 14 px |
//! | oblique view | nine in ten boxes of correct readings are wider than half the widest: 60 degrees | nothing beyond 60 degrees |
//! | between two readings of one plate, at most 4 s apart | read in 41 of 47 | `missed_share` of [`super::noise`], 13 % |
//! | read correctly, except for a lost dot | 188 of 265, 71 % | 71 % |
//! | cut off at one end | 26, 10 % | 10 % |
//! | another code | 51, 19 %, including railings misread as plates | 15 %, and 4 % throughout a visit |
//! | text where there is none: single letters, rows of zeros | 219, in 175 photographs | one in 17 % of the images, a second in 20 % of those |
//!
//! One simplification: errors are drawn independently for each image, although real ones are correlated in similar
//! images.

use super::camera::IMAGE_PX;
use super::misreading::misread;
use crate::hotel::building::signs::Sign;
use crate::hotel::rng::SeededRng;

/// The class of its readings: it does not distinguish plates from exit signs.
pub const CLASS: &str = "sign";
/// Height of letters, as a share of the sign's height.
const LETTER_SHARE: f64 = 0.5;
/// Height below which letters are not read, in pixels.
const LETTER_MIN_PX: f64 = 10.0;
/// Height below which only half of the letters are read, in pixels.
const LETTER_CLEAR_PX: f64 = 14.0;
const UNCLEAR_READ_SHARE: f64 = 0.5;
/// Minimum apparent width, as a share of the true one, at which signs are read: 60 degrees from the normal.
const NARROWEST: f64 = 0.5;
/// Shares of readings that are cut off, and of those with a wrong character.
const CUT_SHARE: f64 = 0.10;
const OTHER_SHARE: f64 = 0.15;
/// Share of images with a reading where there is no text, and of those the share with a second.
const IMAGINED_SHARE: f64 = 0.17;
const IMAGINED_TWICE_SHARE: f64 = 0.2;
/// Share of these that are single letters; the others are rows of zeros.
const SINGLE_LETTER_SHARE: f64 = 0.67;
const SINGLE_LETTERS: [&str; 12] = ["H", "0", "L", "G", "C", "e", "O", "E", "D", "W", "口", "二"];
const ROW_OF_ZEROS: [usize; 2] = [2, 9];
/// Range of the height of such readings, in pixels.
const IMAGINED_PX: [f64; 2] = [12.0, 90.0];

/// Reads a sign that looks like `text` in this box, `[x0, y0, x1, y1]` in pixels; none if it is too small or too
/// oblique.
pub fn read(text: &str, sign: &Sign, bounding_box: [f64; 4], rng: &mut SeededRng) -> Option<String> {
    let [x0, y0, x1, y1] = bounding_box;
    let (width_px, height_px) = (x1 - x0, y1 - y0);
    let letters_px = LETTER_SHARE * height_px;
    let shape = sign.half_size_m[0] / sign.half_size_m[1];
    if letters_px < LETTER_MIN_PX || width_px < NARROWEST * shape * height_px {
        return None;
    }
    if letters_px < LETTER_CLEAR_PX && !rng.happens(UNCLEAR_READ_SHARE) {
        return None;
    }
    if rng.happens(CUT_SHARE) {
        return Some(cut(text, rng));
    }
    Some(if rng.happens(OTHER_SHARE / (1.0 - CUT_SHARE)) { misread(text, rng) } else { text.to_owned() })
}

/// Draws readings where there is no text, with their boxes in pixels.
pub fn imagine(rng: &mut SeededRng) -> Vec<(String, [f64; 4])> {
    if !rng.happens(IMAGINED_SHARE) {
        return Vec::new();
    }
    let count = if rng.happens(IMAGINED_TWICE_SHARE) { 2 } else { 1 };
    (0..count).map(|_| imagined(rng)).collect()
}

fn imagined(rng: &mut SeededRng) -> (String, [f64; 4]) {
    let text = if rng.happens(SINGLE_LETTER_SHARE) {
        (*rng.one_of(&SINGLE_LETTERS)).to_owned()
    } else {
        "0".repeat(ROW_OF_ZEROS[0] + rng.below(ROW_OF_ZEROS[1] - ROW_OF_ZEROS[0]))
    };
    let height_px = rng.within(IMAGINED_PX[0], IMAGINED_PX[1]);
    let width_px = 0.6 * height_px * text.chars().count() as f64;
    let x = rng.within(0.0, (IMAGE_PX[0] - width_px).max(1.0));
    let y = rng.within(0.0, IMAGE_PX[1] - height_px);
    (text, [x, y, (x + width_px).min(IMAGE_PX[0]), y + height_px])
}

/// Returns a text without its first or last character.
fn cut(text: &str, rng: &mut SeededRng) -> String {
    let mut characters: Vec<char> = text.chars().collect();
    if characters.len() > 1 {
        let at = if rng.happens(0.5) { 0 } else { characters.len() - 1 };
        characters.remove(at);
    }
    characters.into_iter().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hotel::building::signs::SignKind;

    fn plate() -> Sign {
        Sign {
            kind: SignKind::DoorPlate,
            text: String::from("901"),
            centre: [0.0; 3],
            normal: [1.0, 0.0],
            half_size_m: [0.10, 0.07],
            points: 0..0,
        }
    }

    fn readings(width_px: f64, height_px: f64) -> Vec<Option<String>> {
        let mut rng = SeededRng::new(1, "ocr");
        let box_px = [100.0, 100.0, 100.0 + width_px, 100.0 + height_px];
        (0..4_000).map(|_| read("901", &plate(), box_px, &mut rng)).collect()
    }

    #[test]
    fn letters_that_are_small_or_seen_from_aside_are_not_read() {
        let share = |width_px, height_px| {
            readings(width_px, height_px).iter().filter(|read| read.is_some()).count() as f64 / 4_000.0
        };
        // The plate's shape is 10 to 7, and its letters have half its height.
        for (height_px, is_read) in [(19.0, 0.0), (24.0, 0.5), (30.0, 1.0), (200.0, 1.0)] {
            let share = share(height_px * 10.0 / 7.0, height_px);
            assert!((share - is_read).abs() < 0.03, "{height_px} px: {share}");
        }
        for (narrower, is_read) in [(0.52, 1.0), (0.48, 0.0)] {
            let share = share(60.0 * narrower * 10.0 / 7.0, 60.0);
            assert!((share - is_read).abs() < 1e-9, "{narrower}: {share}");
        }
    }

    #[test]
    fn readings_are_right_cut_or_another_code_as_often_as_on_real_photographs() {
        let all: Vec<String> = readings(100.0, 70.0).into_iter().flatten().collect();
        let share =
            |is: &dyn Fn(&str) -> bool| all.iter().filter(|text| is(text)).count() as f64 / all.len() as f64;
        let right = share(&|text| text == "901");
        let shorter = share(&|text| text.len() < 3);
        assert!((right - 0.75).abs() < 0.03, "71 % and the 4 % that glare takes: {right}");
        // A quarter of the other codes has lost a character, too.
        assert!((shorter - (0.10 + 0.25 * 0.15)).abs() < 0.03, "{shorter}");
    }

    #[test]
    fn every_fifth_image_has_a_text_that_is_none() {
        let mut rng = SeededRng::new(1, "imagined");
        let images: Vec<_> = (0..5_000).map(|_| imagine(&mut rng)).collect();
        let texts: Vec<&(String, [f64; 4])> = images.iter().flatten().collect();
        let per_image = texts.len() as f64 / images.len() as f64;
        assert!((per_image - 219.0 / 1_056.0).abs() < 0.02, "{per_image}");
        for (text, [x0, y0, x1, y1]) in texts {
            assert!(!text.is_empty() && 0.0 <= *x0 && x0 < x1 && *x1 <= IMAGE_PX[0], "{text}");
            assert!(0.0 <= *y0 && y0 < y1 && *y1 <= IMAGE_PX[1], "{text}");
        }
    }
}
