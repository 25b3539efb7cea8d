//! Reader: simulates text recognition, or a model that describes pictures.

use std::collections::HashMap;

use super::misreading::misread;
use super::noise::Noise;
use super::ocr;
use crate::hotel::building::signs::{Sign, SignKind};
use crate::hotel::rng::SeededRng;

/// Synonyms for descriptions of the same painting, in both directions.
const SYNONYMS: [(&str, &str); 12] = [
    ("sunset", "dusk"),
    ("dawn", "sunrise"),
    ("moonlight", "night"),
    ("fog", "mist"),
    ("mountains", "peaks"),
    ("seaside", "beach"),
    ("rain", "downpour"),
    ("umbrella", "parasol"),
    ("bicycle", "bike"),
    ("wagon", "cart"),
    ("sailboat", "yacht"),
    ("locomotive", "train"),
];

/// The reader of the signs of one visit.
#[derive(Clone, Debug)]
pub struct Reader {
    noise: Noise,
    /// Each plate as it looks in this visit's light, which may disguise it.
    plates: HashMap<usize, String>,
    visit: usize,
}

impl Reader {
    /// Returns a reader with this noise.
    pub fn new(noise: Noise) -> Self {
        Self { noise, plates: HashMap::new(), visit: usize::MAX }
    }

    /// Reads a sign in this box, in pixels; returns the class and the text of the detection, none if it sees no text.
    pub fn detect(
        &mut self,
        number: usize,
        sign: &Sign,
        bounding_box: [f64; 4],
        visit: usize,
        rng: &mut SeededRng,
    ) -> Option<(&'static str, String)> {
        let text = self.read(number, sign, visit, rng);
        if !self.noise.ocr || sign.kind == SignKind::Painting {
            return Some((sign.kind.as_str(), text));
        }
        Some((ocr::CLASS, ocr::read(&text, sign, bounding_box, rng)?))
    }

    /// Draws readings where there is no text, with their boxes in pixels.
    pub fn imagine(&self, rng: &mut SeededRng) -> Vec<(String, [f64; 4])> {
        if self.noise.ocr { ocr::imagine(rng) } else { Vec::new() }
    }

    /// Returns its reading of the sign in this image.
    fn read(&mut self, number: usize, sign: &Sign, visit: usize, rng: &mut SeededRng) -> String {
        if self.visit != visit {
            self.visit = visit;
            self.plates.clear();
        }
        if sign.kind == SignKind::Painting {
            return self.describe(&sign.text, rng);
        }
        if sign.kind != SignKind::DoorPlate {
            return sign.text.clone();
        }
        let looks = self.plates.entry(number).or_insert_with(|| {
            if rng.happens(self.noise.glare_share) { misread(&sign.text, rng) } else { sign.text.clone() }
        });
        let mut number_read = looks.clone();
        if rng.happens(self.noise.misread_share) {
            number_read = misread(&number_read, rng);
        }
        if self.noise.other_wording {
            let wording =
                *rng.one_of(&["{}", "Room {}", "door number {}", "a door plate that reads {}", "No. {}"]);
            return wording.replace("{}", &number_read);
        }
        number_read
    }

    fn describe(&self, title: &str, rng: &mut SeededRng) -> String {
        if !self.noise.other_wording {
            return title.to_owned();
        }
        let mut described = title.to_owned();
        for (word, other) in SYNONYMS {
            if rng.happens(0.5) {
                described = described.replace(word, other);
            }
        }
        let what = described.trim_start_matches("a painting of ");
        let wording = *rng.one_of(&[
            "a painting of {}",
            "a framed picture that shows {}",
            "{}, oil on canvas",
            "artwork with {}",
        ]);
        wording.replace("{}", what)
    }
}
