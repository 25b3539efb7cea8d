//! What the tokens around a number say of it: its role, its range, its spelling.

use crate::semantics::lexicon::dictionary::{self, Class};
use crate::semantics::lexicon::misreading;
use crate::semantics::lexicon::role::{self, Role};
use crate::semantics::lexicon::word_list::WordList;
use crate::semantics::parsing::direction;
use crate::semantics::parsing::token::{Kind, Token};

/// The tokens of a text, with their lower-case spelling without diacritics.
#[derive(Clone, Copy)]
pub struct Around<'t> {
    /// The tokens.
    pub tokens: &'t [Token<'t>],
    /// Their spelling.
    pub bare: &'t [String],
}

impl Around<'_> {
    /// Returns the role that the words right before `at` give, and the first of these words.
    pub fn role_before(&self, at: usize) -> Option<(Role, usize)> {
        let mut first = at;
        while first > 0 && !self.tokens[first].after_break {
            first -= 1;
            let word = self.bare[first].as_str();
            if let Some(role) = role::role_of(word) {
                // "North wing 5" is number 5 of a wing that has a name, and "wing 5" is a wing.
                return (!role.is_named_part() || !self.is_named(first)).then_some((role, first));
            }
            if !role::is_number_label(word) {
                return None;
            }
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
                && self.role_before(before).is_none()
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
        let number = ordinal(&self.bare[at]).is_some() || number_word(&self.bare[at]).is_some();
        let floor = role::role_of(&self.bare[at + 1]) == Some(Role::Floor);
        let another = self.tokens.get(at + 2).is_some_and(|t| t.kind == Kind::Code && !t.after_break);
        number && floor && next.kind == Kind::Word && !another
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
        let follows = || self.tokens[at + 1..].iter().take(2).take_while(|token| !token.after_break);
        let is_of_role = at.checked_sub(1).is_some_and(|before| role::role_of(&self.bare[before]).is_some());
        role::is_number_label(&self.bare[at])
            && (is_of_role || follows().any(|token| token.kind == Kind::Code))
    }

    /// "Room B", "floor nine". Vowels are words in some language, so no word may follow but grammar and a role: "building A
    /// room 5".
    pub fn spelt_number(&self, role: Role, at: usize) -> Option<String> {
        let word = self.bare[at].as_str();
        let next = self.bare.get(at + 1).filter(|_| self.is_before_word(at));
        let ends = next.is_none_or(|next| dictionary::listed(next) == Some(Class::Function));
        let is_letter =
            word.chars().nth(1).is_none() && (ends || role.is_container() || !"aeiouy".contains(word));
        let number = || number_word(word).filter(|_| ends || !word.ends_with("th"));
        if is_letter || ROMAN_NUMERALS.has(word) { Some(word.to_owned()) } else { number() }
    }

    /// "On the left": where a thing hangs, and not where it points.
    pub fn is_location(&self, at: usize) -> bool {
        let is_after_article = at.checked_sub(1).is_some_and(|before| self.bare[before] == "the");
        is_after_article && direction::is_direction(&dictionary::stem(&self.bare[at]))
    }
}

/// "room901", "hub-10": a role word glued to its number.
pub fn glued_role(code: &str) -> Option<(Role, String)> {
    let letters = code.find(|c: char| !c.is_alphabetic()).filter(|letters| *letters > 1)?;
    let (word, number) = code.split_at(letters);
    let number = number.trim_start_matches(['-', '.']).to_owned();
    let role = role::role_of(word).or_else(|| role::is_number_label(word).then_some(Role::Neutral))?;
    Some((role, number))
}

/// "2nd", "9e", "9": the number of an ordinal.
fn ordinal(code: &str) -> Option<&str> {
    let digits = code.find(|c: char| !c.is_ascii_digit()).unwrap_or(code.len());
    let (number, ending) = code.split_at(digits);
    let endings = ["", "st", "nd", "rd", "th", "e", "er", "eme", "o", "a", "°"];
    ((1..=2).contains(&digits) && endings.contains(&ending)).then_some(number)
}

/// Roman numerals of two letters or more: "Hall III".
static ROMAN_NUMERALS: WordList = WordList::of(
    "ii iii iv vi vii viii ix xi xii xiii xiv xv xvi xvii xviii xix xx xxi xxii xxiii xxiv xxv xxvi xxvii xxviii xxix xxx",
);

/// Returns the number that a word is, in digits.
pub fn number_word(word: &str) -> Option<String> {
    const WORDS: [&str; 2] = [
        "ground one two three four five six seven eight nine ten eleven twelve",
        "ground first second third fourth fifth sixth seventh eighth ninth tenth eleventh twelfth",
    ];
    let number = WORDS.iter().find_map(|words| words.split(' ').position(|other| other == word))?;
    Some(number.to_string())
}
