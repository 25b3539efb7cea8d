//! Reading a text: which of its tokens are identifiers, quantities, negations and words.

use crate::semantics::lexicon::dictionary::{self, Class};
use crate::semantics::lexicon::generic;
use crate::semantics::lexicon::misreading;
use crate::semantics::lexicon::role::{self, Role};
use crate::semantics::lexicon::word_list::WordList;
use crate::semantics::lexicon::words::Word;
use crate::semantics::names::identifier::Identifier;
use crate::semantics::parsing::context::{self, Around};
use crate::semantics::parsing::direction;
use crate::semantics::parsing::frame::Frame;
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
    /// They name one thing.
    Identifier(Identifier),
    /// A word that counts.
    Word {
        /// The word.
        word: Word,
        /// A "no" or "not" bears on it.
        negated: bool,
    },
    /// A letter that is an article or a conjunction unless it is part of a name: "a boat", "A tower 12".
    Article(String),
}

/// Reading of a text, token by token.
#[derive(Clone, Debug)]
pub struct Reading {
    /// Mentions, in order.
    pub mentions: Vec<Mention>,
    /// Whether it describes in a sentence what a sign looks like, so that not all of its words are on the sign.
    pub is_caption: bool,
    /// Whether it tells what a picture shows.
    pub is_of_picture: bool,
}

/// Words that a sentence about a sign has: indefinite articles, and what is said of letters. Beside other grammar they make one.
static CAPTION: WordList = WordList::of(
    "an ein eine einen einem einer un une una uma een showing saying displaying reading letters lettering characters \
     digits text inscription",
);

/// Reads the tokens of a normalised text.
pub fn read(tokens: &[Token<'_>]) -> Reading {
    let bare: Vec<String> = tokens.iter().map(|token| bare(token.text)).collect();
    let words: Vec<&str> = bare.iter().map(String::as_str).collect();
    let frame = Frame::of(&words, |at| tokens[at].after_break);
    let around = Around { tokens, bare: &bare };
    let tells = bare.iter().any(|word| CAPTION.has(word))
        || (0..tokens.len()).any(|at| bare[at] == "a" && around.is_before_word(at));
    let is_grammar = |word: &String| {
        dictionary::listed(word) == Some(Class::Function)
            && word.chars().nth(1).is_some()
            && !role::is_number_label(word)
            && !CAPTION.has(word)
    };
    let is_caption =
        (tells && bare.iter().any(is_grammar)) || (0..tokens.len()).any(|at| frame.leaves_out(at));
    let mut reader =
        Reader { tokens, frame, bare: &bare, around, is_caption, mentions: Vec::new(), negation: None };
    let mut at = 0;
    while at < tokens.len() && reader.mentions.len() < MAX_TOKENS {
        at += reader.step(at);
    }
    reader.negate_last();
    let is_of_picture = reader.frame.is_of_picture(&words);
    Reading { mentions: reader.mentions, is_caption: reader.is_caption, is_of_picture }
}

struct Reader<'t> {
    tokens: &'t [Token<'t>],
    bare: &'t [String],
    frame: Frame,
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
        let (name, role) = match self.around.role_before(at) {
            name @ Some((Role::Named(_), _)) => (name, None),
            role => (None, role),
        };
        let quantity = quantity::tokens_at(self.tokens, self.bare, at, role.is_some(), self.is_caption);
        if quantity > 0 && !self.around.is_ordinal_floor(at) {
            let text = self.bare[at..at + quantity].concat();
            self.word(Word::of_class(Class::Quantity, text), at, at + quantity);
            return quantity;
        }
        match self.tokens[at].kind {
            Kind::Code => self.code(at, role, name),
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

    /// A word that is no role word gives a `name` only where nothing else tells a role: "Copernicus 3".
    fn code(&mut self, at: usize, role: Option<(Role, usize)>, name: Option<(Role, usize)>) -> usize {
        let code = self.bare[at].as_str();
        if code.len() > MAX_CODE_LEN {
            self.word(Word::new(code.to_owned()), at, at + 1);
            return 1;
        }
        if let Some(word) = misreading::misread_code(code).filter(|_| role.is_none()) {
            self.word(Word::new(word.to_owned()), at, at + 1);
            return 1;
        }
        let first = role.as_ref().map_or(at, |(_, first)| *first);
        // An accent tells one letter from another.
        let written = self.tokens[at].text;
        if let Some((range, len)) = self.around.spelt_range(at) {
            let role = role.map_or(Role::Neutral, |(role, _)| role);
            self.identifier(role, &range, first, at + len);
            return len;
        } else if let Some((role, _)) = role {
            self.identifiers(&role, written, first, at + 1);
        } else if let Some((role, number, suffix)) = self.around.suffixed(at) {
            // What is counted stands behind the number: 3番線.
            let place = if let Role::Place(place) = role { Some(place) } else { None };
            let place = place.filter(|_| !role.is_container());
            self.identifier(if place.is_some() { Role::Neutral } else { role }, &number, at, at + 2);
            if let Some(place) = place {
                self.word(Word::new(place.to_owned()), at, at + 2);
            }
            if suffix < self.tokens[at + 1].text.len() {
                self.run(&self.tokens[at + 1].text[suffix..], at + 1);
            }
            return 2;
        } else if let Some((role, number, len)) = self.around.role_after(at) {
            self.identifier(role, &number, at, at + len);
            return len;
        } else if let Some((role, number)) = context::glued_role(code) {
            self.identifiers(&role, &number, at, at + 1);
        } else {
            let role = name.or_else(|| Some((self.role_of_list(at)?, at)));
            let (role, first) = role.unwrap_or((Role::Neutral, at));
            self.identifiers(&role, written, first, at + 1);
        }
        1
    }

    fn letters(&mut self, at: usize, role: Option<(Role, usize)>) -> usize {
        let bare = self.bare;
        let word = bare[at].as_str();
        let phrase = generic::phrase(&bare[at..]);
        if phrase > 0 && !self.tokens[at + 1..at + phrase].iter().any(|token| token.after_break) {
            for (i, word) in bare[at..at + phrase].iter().enumerate() {
                self.word(Word::of_class(Class::Generic, dictionary::stem(word)), at + i, at + i + 1);
            }
            return phrase;
        }
        if let Some((role, first)) = &role
            && let Some(number) = self.around.letter_and_number(role, at)
        {
            self.identifier(role.clone(), &number, *first, at + 2);
            return 2;
        }
        if let Some((role, first)) = role
            && let Some(number) = self.around.spelt_number(&role, at)
        {
            self.identifier(role, &number, first, at + 1);
        } else if self.around.is_ordinal_floor(at) {
            let number = context::number_word(word).unwrap_or_default().to_owned();
            self.identifier(Role::Floor, &number, at, at + 2);
            return 2;
        } else if dictionary::negates(word) {
            self.negation = Some(at).filter(|_| !self.around.is_label(at));
        } else if self.around.is_location(at) {
            // Where the thing hangs, not where it points; and left of it is not right of it.
            self.word(Word::location(&dictionary::stem(word)), at, at + 1);
        } else if self.frame.is_empty_at(at) {
            self.word(Word::of_class(Class::Generic, dictionary::stem(word)), at, at + 1);
        } else if word.chars().nth(1).is_none() && word.chars().all(char::is_alphabetic) {
            self.letter(at);
        } else if !self.frame.leaves_out(at) && !self.around.is_particle(at) {
            self.word(Word::new(dictionary::stem(word)), at, at + 1);
        }
        1
    }

    /// One letter is part of a name, unless it may be a word and another word follows. Its accent tells it from others.
    fn letter(&mut self, at: usize) {
        let letter = self.tokens[at].text.to_owned();
        if self.around.is_before_word(at) && dictionary::listed(&self.bare[at]) == Some(Class::Function) {
            self.mentions.push(Mention { what: What::Article(letter), first: at, end: at + 1 });
        } else {
            // Nobody denies a letter.
            self.negation = None;
            self.word(Word::of_class(Class::Letter, letter), at, at + 1);
        }
    }

    /// "三楼会议室" is room "会议室" on floor 3: a numeral straight before what it numbers is a number.
    fn ideographs(&mut self, at: usize) -> usize {
        let mut rest = self.tokens[at].text;
        while let Some((before, number, role, after)) = numeral::first_numbered(rest) {
            if !before.is_empty() {
                self.run(before, at);
            }
            self.identifier(role, &number, at, at + 1);
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
        let is_named = identifier.role != Role::Neutral && !identifier.role.is_container();
        let carried = || before.first + 1 == before.end && is_named;
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
        if role == Role::Neutral && noise::is_noise_number(code) {
            return;
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
