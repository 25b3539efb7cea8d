//! Reading a text: which of its tokens are numbers, quantities, negations and words.

use crate::semantics::lexicon::dictionary::{self, Class};
use crate::semantics::lexicon::generic;
use crate::semantics::lexicon::misreading;
use crate::semantics::lexicon::role::Role;
use crate::semantics::lexicon::words::Word;
use crate::semantics::parsing::caption;
use crate::semantics::parsing::context::{self, Around};
use crate::semantics::parsing::direction;
use crate::semantics::parsing::noise;
use crate::semantics::parsing::normalise::bare;
use crate::semantics::parsing::numeral;
use crate::semantics::parsing::quantity;
use crate::semantics::parsing::token::{Kind, MAX_TOKENS, Token};

/// Longer codes are serial numbers gone wrong or noise, and are compared as words.
const MAX_CODE_LEN: usize = 24;

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
    /// A number or code, and what it is of.
    Number(Role, String),
    /// A word that counts, or a letter. Of [`Class::Function`] are letters that are articles or conjunctions unless they are
    /// part of a name: "a boat", "A tower 12".
    Word {
        /// The word.
        word: Word,
        /// A "no" or "not" bears on it.
        negated: bool,
    },
}

/// Reading of a text, token by token.
#[derive(Clone, Debug, Default)]
pub struct Reading {
    /// Mentions, in order.
    pub mentions: Vec<Mention>,
    /// Whether it describes in a sentence what is to be seen, so that not all of its words are on a sign.
    pub is_caption: bool,
    /// Whether it tells what a picture shows.
    pub is_of_picture: bool,
}

impl Reading {
    /// Returns the words, or only those that are denied.
    pub fn words(&self, negated_only: bool) -> impl Iterator<Item = &Word> {
        self.mentions.iter().filter_map(move |mention| match &mention.what {
            What::Word { word, negated } if *negated || !negated_only => Some(word),
            _ => None,
        })
    }

    /// Whether a word tells what a number is of.
    pub fn tells_role(&self) -> bool {
        let is_told = |what: &What| matches!(what, What::Number(role, _) if *role != Role::Neutral);
        self.mentions.iter().any(|mention| is_told(&mention.what))
    }
}

/// Reads the tokens of a normalised text.
pub fn read(tokens: &[Token<'_>]) -> Reading {
    let bare: Vec<String> = tokens.iter().map(|token| bare(token.text)).collect();
    let around = Around { tokens, bare: &bare };
    let is_caption = caption::is_caption(&around);
    let mut reader = Reader { tokens, bare: &bare, around, is_caption, mentions: Vec::new(), negation: None };
    let mut at = 0;
    while at < tokens.len() && reader.mentions.len() < MAX_TOKENS {
        at += reader.step(at);
    }
    reader.negate_last();
    let mut mentions = reader.mentions;
    let introduces =
        |what: &What| matches!(what, What::Word { word, negated: false } if caption::is_noun(&word.text));
    let is_grammar = |what: &What| matches!(what, What::Word { word, .. } if word.class == Class::Function);
    // A number that is noise is no mention, and still what the caption shows.
    let shows_more = tokens.iter().any(|token| token.kind == Kind::Code)
        || mentions.iter().any(|Mention { what, .. }| !introduces(what) && !is_grammar(what));
    if is_caption && shows_more {
        mentions.retain(|mention| !introduces(&mention.what));
    }
    Reading { mentions, is_caption, is_of_picture: is_caption && caption::is_of_picture(&bare) }
}

struct Reader<'t> {
    tokens: &'t [Token<'t>],
    bare: &'t [String],
    around: Around<'t>,
    is_caption: bool,
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
        let role = self.around.role_before(at);
        let quantity = quantity::tokens_at(&self.around, at, role.is_some(), self.is_caption);
        if quantity > 0 && !self.around.is_ordinal_floor(at) {
            let text = self.bare[at..at + quantity].concat();
            self.word(Word::of_class(Class::Quantity, text), at, at + quantity);
            return quantity;
        }
        match self.tokens[at].kind {
            Kind::Code => self.code(at, role),
            Kind::Word => self.letters(at, role),
            Kind::Ideographs => self.ideographs(at),
            Kind::Symbol => {
                let symbol = self.bare[at].as_str();
                if !["#", "+", "\u{b0}", "%", "$"].contains(&symbol) {
                    let word = match direction::named(symbol) {
                        Some(direction) => Word::new(direction.to_owned()),
                        None => Word::of_class(Class::Generic, symbol.to_owned()),
                    };
                    self.word(word, at, at + 1);
                }
                1
            }
        }
    }

    fn code(&mut self, at: usize, role: Option<(Role, usize)>) -> usize {
        let code = self.bare[at].as_str();
        let misread = misreading::misread_code(code).filter(|_| role.is_none());
        if code.len() > MAX_CODE_LEN || misread.is_some() {
            self.word(Word::new(misread.unwrap_or(code).to_owned()), at, at + 1);
            return 1;
        }
        // An accent tells one letter from another.
        let written = self.tokens[at].text;
        if let Some((role, first)) = role {
            self.numbers(role, written, first, at + 1);
        } else if let Some((role, number, suffix)) = self.around.suffixed(at) {
            // What is counted stands behind the number: 3番線.
            let place = if let Role::Place(place) = role { Some(place) } else { None };
            let place = place.filter(|_| !role.is_container());
            self.number(if place.is_some() { Role::Neutral } else { role }, &number, at, at + 2);
            if let Some(place) = place {
                self.word(Word::new(place.to_owned()), at, at + 2);
            }
            if suffix < self.tokens[at + 1].text.len() {
                self.run(&self.tokens[at + 1].text[suffix..], at + 1);
            }
            return 2;
        } else if let Some((role, number, len)) = self.around.role_after(at) {
            self.number(role, &number, at, at + len);
            return len;
        } else {
            let (role, number) = context::glued_role(code).unwrap_or((Role::Neutral, written.to_owned()));
            self.numbers(role, &number, at, at + 1);
        }
        1
    }

    fn letters(&mut self, at: usize, role: Option<(Role, usize)>) -> usize {
        let bare = self.bare;
        let word = bare[at].as_str();
        let phrase = generic::phrase(&bare[at..]);
        if phrase > 0 && !self.tokens[at + 1..at + phrase].iter().any(|token| token.after_break) {
            for (at, word) in bare.iter().enumerate().skip(at).take(phrase) {
                self.word(Word::of_class(Class::Generic, dictionary::stem(word)), at, at + 1);
            }
            return phrase;
        }
        if let Some((role, first)) = role
            && let Some(number) = self.around.spelt_number(role, at)
        {
            self.number(role, &number, first, at + 1);
        } else if self.around.is_ordinal_floor(at) {
            let number = context::number_word(word).unwrap_or_default();
            self.number(Role::Floor, &number, at, at + 2);
            return 2;
        } else if dictionary::negates(word) {
            self.negation = Some(at).filter(|_| !self.around.is_label(at));
        } else if self.around.is_location(at) {
            self.word(Word::location(&dictionary::stem(word)), at, at + 1);
        } else if word.chars().nth(1).is_none() && word.chars().all(char::is_alphabetic) {
            self.letter(at);
        } else {
            self.word(Word::new(dictionary::stem(word)), at, at + 1);
        }
        1
    }

    /// One letter is part of a name, unless it may be a word and another word follows. Its accent tells it from others.
    fn letter(&mut self, at: usize) {
        let is_article =
            self.around.is_before_word(at) && dictionary::listed(&self.bare[at]) == Some(Class::Function);
        let class = if is_article { Class::Function } else { Class::Letter };
        // Nobody denies a letter.
        self.negation = self.negation.filter(|_| is_article);
        let word = Word::of_class(class, self.tokens[at].text.to_owned());
        self.mentions.push(Mention { what: What::Word { word, negated: false }, first: at, end: at + 1 });
    }

    /// "三楼会议室" is room "会议室" on floor 3: a numeral straight before what it numbers is a number.
    fn ideographs(&mut self, at: usize) -> usize {
        let mut rest = self.tokens[at].text;
        while let Some((before, number, role, after)) = numeral::first_numbered(rest) {
            if !before.is_empty() {
                self.run(before, at);
            }
            self.number(role, &number, at, at + 1);
            rest = after;
        }
        if !rest.is_empty() {
            self.run(rest, at);
        }
        1
    }

    /// No spaces part these words, so a run unknown to the dictionary counts as its pairs of characters.
    fn run(&mut self, run: &str, at: usize) {
        if dictionary::negates(run) {
            self.negation = Some(at);
        } else if misreading::class_of(run) != Class::Specific || run.chars().nth(2).is_none() {
            self.word(Word::new(run.to_owned()), at, at + 1);
        } else if let Some(words) = dictionary::split(run) {
            for word in words.into_iter().take(MAX_TOKENS) {
                if dictionary::negates(word) {
                    self.negation = Some(at);
                } else {
                    self.word(Word::new(word.to_owned()), at, at + 1);
                }
            }
        } else {
            let starts: Vec<usize> = run.char_indices().map(|(start, _)| start).chain([run.len()]).collect();
            for pair in starts.windows(3).take(MAX_TOKENS) {
                self.word(Word::new(run[pair[0]..pair[2]].to_owned()), at, at + 1);
            }
        }
    }

    /// One code may hold several: 901/902.
    fn numbers(&mut self, role: Role, codes: &str, first: usize, end: usize) {
        for code in codes.split(['/', ',']) {
            self.number(role, code, first, end);
        }
    }

    fn number(&mut self, role: Role, code: &str, first: usize, end: usize) {
        // "No 5" numbers, it does not deny.
        self.negation = None;
        if role != Role::Neutral || !noise::is_noise_number(code) {
            self.mentions.push(Mention { what: What::Number(role, code.to_owned()), first, end });
        }
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
        // "A picture of no, 901" has no picture that it denies.
        let introduces = |word: &Word| self.is_caption && caption::is_noun(&word.text);
        if let Some(Mention { what: What::Word { word, negated }, end, .. }) = self.mentions.last_mut()
            && !introduces(word)
        {
            *negated = true;
            *end = no + 1;
        }
    }
}
