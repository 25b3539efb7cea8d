//! Reader: the text that it makes of a sign.

use super::world::{Sign, SignKind, World};
use crate::hotel::rng::SeededRng;

/// Characters that a reader takes for one another, or for any other.
const TAKEN_FOR: [(char, char); 8] =
    [('1', '7'), ('0', '8'), ('3', '8'), ('5', '6'), ('2', '7'), ('4', '9'), ('A', 'R'), ('B', 'D')];

/// The errors of one session: a plate misread for a whole passage is misread alike in each of its keyframes.
#[derive(Clone, Debug)]
pub struct Reader<'w> {
    world: &'w World,
    session: usize,
    rng: SeededRng,
}

impl<'w> Reader<'w> {
    /// Returns the reader of a session.
    pub fn new(world: &'w World, session: usize) -> Self {
        Self { world, session, rng: SeededRng::new(world.seed, &format!("reader {session}")) }
    }

    /// Returns what is read of a sign; none if it is missed.
    pub fn read(&mut self, number: usize, sign: &Sign) -> Option<String> {
        let traits = &self.world.traits;
        if self.rng.happens(0.2) {
            return None;
        }
        if sign.kind == SignKind::Picture {
            return Some(sign.text.clone());
        }
        let mut text = sign.text.clone();
        let mut passage = SeededRng::new(self.world.seed, &format!("passage {} {number}", self.session));
        if sign.kind == SignKind::Plate && passage.happens(traits.misread_passage) {
            text = with_error(&text, &mut passage);
        }
        if self.rng.happens(traits.misread) {
            text = if self.rng.happens(0.5) {
                with_error(&text, &mut self.rng)
            } else {
                cut(&text, &mut self.rng)
            };
        }
        (!text.is_empty()).then_some(text)
    }

    /// Returns what is read of a railing or window frame, if any is.
    pub fn railing(&mut self) -> Option<String> {
        const BARS: [&str; 6] = ["111", "1111", "0101", "II", "117", "1101"];
        self.rng.happens(self.world.traits.railings).then(|| (*self.rng.one_of(&BARS)).to_owned())
    }
}

/// Takes one letter or digit for another.
fn with_error(text: &str, rng: &mut SeededRng) -> String {
    let places: Vec<usize> =
        text.chars().enumerate().filter(|(_, c)| c.is_alphanumeric()).map(|(at, _)| at).collect();
    if places.is_empty() {
        return text.to_owned();
    }
    let wrong = *rng.one_of(&places);
    let other = |c: char| {
        let taken = TAKEN_FOR.iter().find_map(|(a, b)| (*a == c).then_some(*b).or((*b == c).then_some(*a)));
        taken.unwrap_or(if c.is_ascii_digit() { '1' } else { c })
    };
    text.chars().enumerate().map(|(at, c)| if at == wrong { other(c) } else { c }).collect()
}

/// Cuts a character off either end.
fn cut(text: &str, rng: &mut SeededRng) -> String {
    let mut chars: Vec<char> = text.chars().collect();
    if rng.happens(0.5) {
        chars.remove(0);
    } else {
        chars.pop();
    }
    chars.into_iter().collect::<String>().trim().to_owned()
}
