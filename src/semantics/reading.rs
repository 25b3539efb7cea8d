//! Reading a text: which of its tokens are identifiers, quantities, negations and words.

use super::dictionary::{self, Class};
use super::direction;
use super::identifier::{self, Identifier};
use super::normalise::bare;
use super::quantity;
use super::role::{self, Role};
use super::token::{Kind, MAX_TOKENS, Token};
use super::words::Word;

/// Longer codes are serial numbers gone wrong or noise, and are compared as words.
const MAX_CODE_LEN: usize = 24;

/// Codes that name a kind of thing, not one thing.
const NOT_IDENTIFIERS: [&str; 10] =
    ["2d", "3d", "4k", "mp3", "mp4", "h2o", "co2", "covid19", "covid-19", "wifi6"];

/// Words after which "up" is no direction: "a close-up of a sign".
const NOT_UPWARD: [&str; 6] = ["close", "lit", "set", "made", "hung", "put"];

/// What one or more tokens in a row say.
#[derive(Clone, Debug)]
pub struct Mention {
    /// What they say.
    pub what: What,
    /// First of the tokens.
    pub first: usize,
    /// One past the last of the tokens.
    pub end: usize,
}

/// What tokens can say.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum What {
    /// They name one thing.
    Identifier(Identifier),
    /// A word that counts.
    Word {
        /// The word.
        word: Word,
        /// A "no" or "not" bears on it.
        negated: bool,
    },
}

/// Reads the tokens of a normalised text.
pub fn read(tokens: &[Token<'_>]) -> Vec<Mention> {
    let bare: Vec<String> = tokens.iter().map(|token| bare(token.text)).collect();
    let mut reader = Reader { tokens, bare: &bare, mentions: Vec::new(), negation: None };
    let mut at = 0;
    while at < tokens.len() && reader.mentions.len() < MAX_TOKENS {
        at += reader.step(at);
    }
    reader.negate_last();
    reader.mentions
}

struct Reader<'t> {
    tokens: &'t [Token<'t>],
    bare: &'t [String],
    mentions: Vec<Mention>,
    /// Token of a "no" that still waits for its word.
    negation: Option<usize>,
}

impl Reader<'_> {
    /// Reads on from token `at`; returns how many tokens that took.
    fn step(&mut self, at: usize) -> usize {
        if self.tokens[at].after_break {
            self.negate_last();
        }
        let role = self.role_before(at);
        let quantity = quantity::tokens_at(self.tokens, self.bare, at, role.is_some());
        if quantity > 0 && !self.is_ordinal_floor(at) {
            let text = self.bare[at..at + quantity].concat();
            self.word(Word::of_class(Class::Quantity, text), at, at + quantity);
            return quantity;
        }
        match self.tokens[at].kind {
            Kind::Code => self.code(at, role),
            Kind::Word => self.letters(at, role),
            Kind::Ideographs => self.ideographs(at),
            Kind::Symbol => {
                let text = &self.bare[at];
                if !["-", "#", "+", "\u{b0}", "%", "$"].contains(&text.as_str()) {
                    let word = direction::of_symbol(text).map_or_else(
                        || Word::of_class(Class::Generic, text.clone()),
                        |name| Word::new(name.to_owned()),
                    );
                    self.word(word, at, at + 1);
                }
                1
            }
        }
    }

    fn code(&mut self, at: usize, role: Option<(Role, usize)>) -> usize {
        let code = self.bare[at].as_str();
        if code.len() > MAX_CODE_LEN || NOT_IDENTIFIERS.contains(&code) {
            self.word(Word::new(code.to_owned()), at, at + 1);
            return 1;
        }
        let first = role.as_ref().map_or(at, |(_, first)| *first);
        if let Some((range, len)) = self.spelt_range(at) {
            let role = role.map_or(Role::Neutral, |(role, _)| role);
            self.identifier(role, &range, first, at + len);
            return len;
        } else if let Some((role, _)) = role {
            self.identifiers(&role, code, first, at + 1);
        } else if let Some((role, number, suffix)) = self.suffixed(at) {
            self.identifier(role, &number, at, at + 2);
            if suffix < self.tokens[at + 1].text.len() {
                self.run(&self.tokens[at + 1].text[suffix..], at + 1);
            }
            return 2;
        } else if let Some((role, number, len)) = self.role_after(at) {
            self.identifier(role, &number, at, at + len);
            return len;
        } else if let Some((role, number)) = glued_role(code) {
            self.identifiers(&role, &number, at, at + 1);
        } else {
            let role = self.role_of_list(at).unwrap_or(Role::Neutral);
            self.identifiers(&role, code, at, at + 1);
        }
        1
    }

    fn letters(&mut self, at: usize, role: Option<(Role, usize)>) -> usize {
        let bare = self.bare;
        let word = bare[at].as_str();
        let listed = role.filter(|(role, _)| !matches!(role, Role::Named(_)));
        if let Some((role, first)) = &listed
            && let Some(number) = self.letter_and_number(at)
        {
            self.identifier(role.clone(), &number, *first, at + 2);
            return 2;
        }
        if let Some((role, first)) = listed
            && let Some(number) = self.spelt_number(at)
        {
            self.identifier(role, &number, first, at + 1);
        } else if self.is_ordinal_floor(at) {
            let number = number_word(word).unwrap_or_default().to_owned();
            self.identifier(Role::Floor, &number, at, at + 2);
            return 2;
        } else if word.len() == 1
            && word.is_ascii()
            && (at == 0 || self.tokens[at].after_break)
            && self.ends_phrase(at)
        {
            // A plaque that says "A".
            self.identifier(Role::Neutral, word, at, at + 1);
        } else if dictionary::negates(word) {
            self.negation = Some(at);
        } else if (word.len() > 1 || !word.is_ascii())
            && !(word == "up" && at > 0 && NOT_UPWARD.contains(&bare[at - 1].as_str()))
        {
            self.word(Word::new(dictionary::stem(word)), at, at + 1);
        }
        1
    }

    fn ideographs(&mut self, at: usize) -> usize {
        self.run(self.tokens[at].text, at);
        1
    }

    /// No spaces part these words, so a run unknown to the dictionary counts as its pairs of characters.
    fn run(&mut self, run: &str, at: usize) {
        if dictionary::negates(run) {
            self.negation = Some(at);
        } else if dictionary::class_of(run) != Class::Specific || run.chars().nth(2).is_none() {
            self.word(Word::new(run.to_owned()), at, at + 1);
        } else {
            let starts: Vec<usize> = run.char_indices().map(|(start, _)| start).chain([run.len()]).collect();
            for pair in starts.windows(3).take(MAX_TOKENS) {
                self.word(Word::new(run[pair[0]..pair[2]].to_owned()), at, at + 1);
            }
        }
    }

    /// The role that the words right before `at` give, and the first of these words.
    fn role_before(&self, at: usize) -> Option<(Role, usize)> {
        let mut first = at;
        let mut label = false;
        while first > 0 && !self.tokens[first].after_break {
            let word = self.bare[first - 1].as_str();
            if let Some((role, _)) = role::role_of(word) {
                return Some((role, first - 1));
            }
            if !role::is_number_label(word) {
                let name = dictionary::stem(word);
                let is_name = !label && self.tokens[first - 1].kind == Kind::Word && word.len() > 1;
                let named =
                    is_name && !dictionary::negates(word) && dictionary::class_of(&name) == Class::Specific;
                return named.then(|| (Role::Named(name), first - 1));
            }
            (first, label) = (first - 1, true);
        }
        None
    }

    /// 901号室, 9階, 地下1階: the role, the number and the length of the suffix.
    fn suffixed(&self, at: usize) -> Option<(Role, String, usize)> {
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
    fn role_after(&self, at: usize) -> Option<(Role, String, usize)> {
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
    fn is_ordinal_floor(&self, at: usize) -> bool {
        let Some(next) = self.tokens.get(at + 1).filter(|t| !t.after_break) else { return false };
        let number = ordinal(&self.bare[at]).or_else(|| number_word(&self.bare[at])).is_some();
        let floor = matches!(role::role_of(&self.bare[at + 1]), Some((Role::Floor, _)));
        let another = self.tokens.get(at + 2).is_some_and(|t| t.kind == Kind::Code && !t.after_break);
        number && floor && next.kind == Kind::Word && !another
    }

    fn ends_phrase(&self, at: usize) -> bool {
        self.tokens.get(at + 1).is_none_or(|next| next.after_break)
    }

    /// "Gate A 12" is gate A12.
    fn letter_and_number(&self, at: usize) -> Option<String> {
        let (letter, number) = (&self.bare[at], self.bare.get(at + 1)?);
        let joined = letter.len() == 1 && !self.ends_phrase(at) && number.bytes().all(|b| b.is_ascii_digit());
        joined.then(|| format!("{letter}{number}"))
    }

    /// "Room B", "floor nine". Vowels are words in some language, so they must end the phrase, or stand before
    /// another numbered thing: "building A room 5".
    fn spelt_number(&self, at: usize) -> Option<String> {
        let word = self.bare[at].as_str();
        let ends = self.ends_phrase(at);
        let ends = ends
            || (self.bare.get(at + 1).is_some_and(|next| role::role_of(next).is_some())
                && self.tokens.get(at + 2).is_some_and(|t| t.kind == Kind::Code && !t.after_break));
        let letter = word.len() == 1 && word.is_ascii() && (ends || !"aeiouy".contains(word));
        if letter {
            Some(word.to_owned())
        } else {
            number_word(word).filter(|_| ends || !word.ends_with("th")).map(str::to_owned)
        }
    }

    /// "901 to 905", "901 - 905".
    fn spelt_range(&self, at: usize) -> Option<(String, usize)> {
        let joined =
            ["-", "to", "bis", "through", "until", "thru"].contains(&self.bare.get(at + 1)?.as_str());
        let range = format!("{}-{}", self.bare[at], self.bare.get(at + 2)?);
        let unbroken = self.tokens[at + 1..=at + 2].iter().all(|t| !t.after_break);
        (joined && unbroken && identifier::is_range(&range.to_uppercase(), 3)).then_some((range, 3))
    }

    /// "rooms 901, 902 and 903": a number goes on with the role of the one before.
    fn role_of_list(&self, at: usize) -> Option<Role> {
        let before = self.mentions.last()?;
        let What::Identifier(identifier) = &before.what else { return None };
        let between = &self.bare[before.end..at];
        let and =
            between.len() == 1 && ["and", "und", "et", "y", "or", "to", "-"].contains(&between[0].as_str());
        let plural = || {
            (before.first..before.end).any(|i| role::role_of(&self.bare[i]).is_some_and(|(_, plural)| plural))
        };
        let carried = || before.first + 1 == before.end && identifier.role != Role::Neutral;
        (and || (between.is_empty() && (plural() || carried()))).then(|| identifier.role.clone())
    }

    /// One code may hold several: 901/902.
    fn identifiers(&mut self, role: &Role, codes: &str, first: usize, end: usize) {
        for code in codes.split(['/', ',']) {
            self.identifier(role.clone(), code, first, end);
        }
    }

    fn identifier(&mut self, role: Role, code: &str, first: usize, end: usize) {
        // "No 5" numbers, it does not deny.
        if self.negation.is_some_and(|no| no + 1 == first || (no >= first && no < end)) {
            self.negation = None;
        }
        let what = What::Identifier(Identifier::new(role, code));
        self.mentions.push(Mention { what, first, end });
    }

    fn word(&mut self, mut word: Word, first: usize, end: usize) {
        if word.class == Class::Function {
            // "Cannot *read*" is what tells an unreadable sign, elsewhere "reads" tells nothing.
            if self.negation.is_none() || !dictionary::is_unsure_when_negated(&word.text) {
                return;
            }
            word = Word::of_class(Class::Generic, word.text);
        }
        let negated = self.negation.take();
        let first = negated.unwrap_or(first);
        self.mentions.push(Mention { what: What::Word { word, negated: negated.is_some() }, first, end });
    }

    /// "Smoking prohibited": a negation that ends its phrase bears on the word before.
    fn negate_last(&mut self) {
        let Some(no) = self.negation.take().filter(|no| !self.tokens[*no].after_break) else { return };
        if let Some(Mention { what: What::Word { negated, .. }, end, .. }) = self.mentions.last_mut() {
            *negated = true;
            *end = no + 1;
        }
    }
}

/// "room901", "hub-10": a role word glued to its number.
fn glued_role(code: &str) -> Option<(Role, String)> {
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

fn number_word(word: &str) -> Option<&'static str> {
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
