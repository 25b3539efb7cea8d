//! What the tokens around a number say of it: its role, its range, its spelling.

use crate::semantics::lexicon::dictionary::{self, Class};
use crate::semantics::lexicon::misreading;
use crate::semantics::lexicon::role::{self, Role};
use crate::semantics::parsing::direction;
use crate::semantics::parsing::frame;
use crate::semantics::parsing::token::{Kind, Token};

/// Words after which "up" is no direction: "a close-up of a sign".
const NOT_UPWARD: [&str; 6] = ["close", "lit", "set", "made", "hung", "put"];

/// The tokens of a text, with their lower-case spelling without diacritics.
#[derive(Clone, Copy)]
pub struct Around<'t> {
    /// The tokens.
    pub tokens: &'t [Token<'t>],
    /// Their spelling.
    pub bare: &'t [String],
}

impl Around<'_> {
    /// Returns the role that the words right before `at` give, and the first of these words. An unlisted word gives
    /// [`Role::Named`].
    pub fn role_before(&self, at: usize) -> Option<(Role, usize)> {
        let mut first = at;
        let mut label = false;
        while first > 0 && !self.tokens[first].after_break {
            let word = self.bare[first - 1].as_str();
            if let Some((role, _)) = role::role_of(word) {
                // "North wing 5" is number 5 of a wing that has a name, and "wing 5" is a wing.
                return (!role.is_named_part() || !self.is_named(first - 1)).then_some((role, first - 1));
            }
            if !role::is_number_label(word) {
                let name = dictionary::stem(word);
                let is_name = !label && self.tokens[first - 1].kind == Kind::Word && word.len() > 1;
                let named =
                    is_name && !dictionary::negates(word) && misreading::class_of(&name) == Class::Specific;
                return named.then(|| (Role::Named(name), first - 1));
            }
            (first, label) = (first - 1, true);
        }
        None
    }

    /// Whether a word or letter straight before tells which one it is.
    fn is_named(&self, at: usize) -> bool {
        let before = at.checked_sub(1).filter(|_| !self.tokens[at].after_break);
        before.is_some_and(|before| {
            let word = self.bare[before].as_str();
            let is_letter = word.chars().nth(1).is_none();
            self.tokens[before].kind == Kind::Word
                && role::role_of(word).is_none()
                // "Building IV block B": the numeral is the building's.
                && !matches!(self.role_before(before), Some((Role::Room | Role::Floor | Role::Place(_), _)))
                && (is_letter || misreading::class_of(&dictionary::stem(word)) != Class::Function)
        })
    }

    /// 901号室, 9階, 地下1階: the role, the number and the length of the suffix.
    pub fn suffixed(&self, at: usize) -> Option<(Role, String, usize)> {
        let code = self.bare[at].as_str();
        let next = self.tokens.get(at + 1).filter(|t| t.kind == Kind::Ideographs && !t.after_break)?;
        let (role, suffix) = role::role_of_suffix(next.text)?;
        let number = code.strip_suffix('f').filter(|_| role == Role::Floor).unwrap_or(code);
        let underground =
            at > 0 && ["地下", "지하"].iter().any(|below| self.tokens[at - 1].text.ends_with(below));
        let below = if underground && role == Role::Floor { "b" } else { "" };
        Some((role, format!("{below}{number}"), suffix))
    }

    /// 9F, 2nd floor, 9. Stock: the role, the number and how many tokens they take.
    pub fn role_after(&self, at: usize) -> Option<(Role, String, usize)> {
        let code = self.bare[at].as_str();
        if self.is_ordinal_floor(at) {
            return Some((Role::Floor, ordinal(code)?.to_owned(), 2));
        }
        let number = ["f", "og"].iter().find_map(|floor| code.strip_suffix(floor))?;
        let digits = number.strip_prefix('b').unwrap_or(number);
        let is_floor = (1..=2).contains(&digits.len()) && digits.bytes().all(|b| b.is_ascii_digit());
        is_floor.then(|| (Role::Floor, number.to_owned(), 1))
    }

    /// "2nd floor", "first floor", "9. Stock" - but not the "9 floor 3" that lists two numbers.
    pub fn is_ordinal_floor(&self, at: usize) -> bool {
        let Some(next) = self.tokens.get(at + 1).filter(|t| !t.after_break) else { return false };
        let number = ordinal(&self.bare[at]).or_else(|| number_word(&self.bare[at])).is_some();
        let floor = matches!(role::role_of(&self.bare[at + 1]), Some((Role::Floor, _)));
        let another = self.tokens.get(at + 2).is_some_and(|t| t.kind == Kind::Code && !t.after_break);
        number && floor && next.kind == Kind::Word && !another
    }

    /// Whether the token is the last, or the last before a comma or full stop.
    pub fn ends_phrase(&self, at: usize) -> bool {
        self.tokens.get(at + 1).is_none_or(|next| next.after_break)
    }

    /// Whether a word of two letters or more follows that is no role word.
    pub fn is_before_word(&self, at: usize) -> bool {
        self.tokens.get(at + 1).is_some_and(|next| {
            next.kind == Kind::Word
                && !next.after_break
                && self.bare[at + 1].chars().nth(1).is_some()
                && role::role_of(&self.bare[at + 1]).is_none()
        })
    }

    /// The "No." of "Room No. Nord 5" announces a number, though a word comes first.
    pub fn is_label(&self, at: usize) -> bool {
        let is_role = |before: usize| role::role_of(&self.bare[before]).is_some();
        let announces = || {
            let after = self.tokens.get(at + 1..=at + 2);
            after
                .is_some_and(|next| next.iter().all(|token| !token.after_break) && next[1].kind == Kind::Code)
        };
        role::is_number_label(&self.bare[at]) && (at.checked_sub(1).is_some_and(is_role) || announces())
    }

    /// "Gate A 12" is gate A12, and "wing A 12" is number 12 of wing A.
    pub fn letter_and_number(&self, role: &Role, at: usize) -> Option<String> {
        if role.is_container() {
            return None;
        }
        let (letter, number) = (&self.bare[at], self.bare.get(at + 1)?);
        let joined = letter.len() == 1 && !self.ends_phrase(at) && number.bytes().all(|b| b.is_ascii_digit());
        joined.then(|| format!("{letter}{number}"))
    }

    /// "Room B", "floor nine". Vowels are words in some language, so they must end the phrase, or stand before
    /// another numbered thing: "building A room 5".
    pub fn spelt_number(&self, role: &Role, at: usize) -> Option<String> {
        let word = self.bare[at].as_str();
        let ends = self.ends_phrase(at) || frame::begins_position(&self.bare[at + 1..]);
        let ends = ends
            || role.is_container()
            || self.tokens[at + 1].kind == Kind::Code
            || (self.bare.get(at + 1).is_some_and(|next| role::role_of(next).is_some())
                && self.tokens.get(at + 2).is_some_and(|t| t.kind == Kind::Code && !t.after_break));
        let letter = word.chars().nth(1).is_none() && (ends || !"aeiouy".contains(word));
        if letter || is_roman_numeral(word) {
            Some(word.to_owned())
        } else {
            number_word(word).filter(|_| ends || !word.ends_with("th")).map(str::to_owned)
        }
    }

    /// "901 to 905", "901 - 905".
    pub fn spelt_range(&self, at: usize) -> Option<(String, usize)> {
        let joined =
            ["-", "to", "bis", "through", "until", "thru"].contains(&self.bare.get(at + 1)?.as_str());
        let range = format!("{}-{}", self.bare[at], self.bare.get(at + 2)?);
        let unbroken = self.tokens[at + 1..=at + 2].iter().all(|t| !t.after_break);
        let of_code = [at, at + 2].iter().all(|at| self.tokens[*at].kind == Kind::Code);
        (joined && unbroken && of_code).then_some((range, 3))
    }

    /// "On the left", "left side", "left of".
    pub fn is_location(&self, at: usize) -> bool {
        let before = |back: usize| at.checked_sub(back).map_or("", |i| self.bare[i].as_str());
        let on_the = before(1) == "the" && ["on", "in", "at"].contains(&before(2));
        let next = self.bare.get(at + 1).map_or("", String::as_str);
        let of = ["side", "corner", "hand", "half", "edge", "of"].contains(&next) && !self.ends_phrase(at);
        (on_the || of) && !self.is_particle(at) && direction::is_direction(&dictionary::stem(&self.bare[at]))
    }

    /// Returns the "up" of "a close-up".
    pub fn is_particle(&self, at: usize) -> bool {
        self.bare[at] == "up" && at > 0 && NOT_UPWARD.contains(&self.bare[at - 1].as_str())
    }
}

/// "room901", "hub-10": a role word glued to its number.
pub fn glued_role(code: &str) -> Option<(Role, String)> {
    let letters = code.find(|c: char| !c.is_alphabetic()).filter(|letters| *letters > 1)?;
    let (word, number) = code.split_at(letters);
    let number = number.trim_start_matches(['-', '.']).to_owned();
    let role = role::role_of(word)
        .map(|(role, _)| role)
        .or_else(|| role::is_number_label(word).then_some(Role::Neutral))?;
    Some((role, number))
}

/// "2nd", "9e", "9": the number of an ordinal.
fn ordinal(code: &str) -> Option<&str> {
    let digits = code.find(|c: char| !c.is_ascii_digit()).unwrap_or(code.len());
    let (number, ending) = code.split_at(digits);
    let endings = ["", "st", "nd", "rd", "th", "e", "er", "eme", "o", "a", "°"];
    ((1..=2).contains(&digits) && endings.contains(&ending)).then_some(number)
}

/// Whether a word of two letters or more is a Roman numeral below 90: "Hall III".
fn is_roman_numeral(word: &str) -> bool {
    let tens = word.trim_start_matches('x');
    let ones = tens.strip_prefix('l').map_or(tens, |rest| rest.trim_start_matches('x'));
    let is_short = word.len() > 1 && word.len() <= 8 && word.len() - tens.len() <= 3;
    is_short && ["", "i", "ii", "iii", "iv", "v", "vi", "vii", "viii", "ix"].contains(&ones)
}

pub fn number_word(word: &str) -> Option<&'static str> {
    const WORDS: [(&str, &str); 13] = [
        ("ground", "0"),
        ("one first", "1"),
        ("two second", "2"),
        ("three third", "3"),
        ("four fourth", "4"),
        ("five fifth", "5"),
        ("six sixth", "6"),
        ("seven seventh", "7"),
        ("eight eighth", "8"),
        ("nine ninth", "9"),
        ("ten tenth", "10"),
        ("eleven eleventh", "11"),
        ("twelve twelfth", "12"),
    ];
    WORDS.iter().find(|(words, _)| words.split(' ').any(|w| w == word)).map(|(_, number)| *number)
}
