//! Frames: the words of a description that tell how its writer puts it, and nothing of the object (M24).
//!
//! Two models put one picture in different frames: "a framed picture showing a boat", "there is a boat in front of a
//! wall". Verbs, prepositions and articles are [`Class::Function`] and never count; the nouns here do so only in a frame:
//! a photo booth is no booth, and "a painting" alone is at least that.

use std::collections::HashSet;
use std::sync::LazyLock;

use crate::semantics::lexicon::dictionary::{self, Class};
use crate::semantics::lexicon::misreading;
use crate::semantics::lexicon::role;
use crate::semantics::lexicon::word_list::WordList;
use crate::semantics::parsing::normalise::bare;

/// Media of pictures: a frame unless it stands before a noun or number of its own ("photo booth", "painting 12").
static MEDIA: WordList = WordList::of(
    "picture painting photo photograph poster print image drawing artwork portrait canvas sketch illustration \
    depiction mural watercolor watercolour snapshot engraving etching fresco tapestry view scene closeup frame \
    bild gemalde foto tableau peinture affiche dessin cuadro pintura imagen quadro dipinto immagine schilderij afbeelding",
);

/// Things that carry a text: a frame before a verb ("a sign that reads exit"), else a thing ("a sign with a red border").
static CARRIERS: WordList = WordList::of("sign signage plate plaque label board panel placard notice");

/// The verbs and links that make a frame of a carrier.
static READS: WordList = WordList::of(
    "that which read reading say saying show showing display displaying indicate indicating state stating \
    bearing labeled labelled marked titled",
);

/// Nouns between a verb and the text itself: "with the text exit".
static TEXTS: WordList = WordList::of("text word inscription caption lettering");

/// Positions of an object in the picture, after a preposition: "in front of", "on the wall".
static POSITIONS: WordList =
    WordList::of("front back wall background foreground middle center centre distance top");

const PREPOSITIONS: [&str; 8] = ["in", "on", "at", "against", "from", "to", "onto", "near"];
const ARTICLES: [&str; 3] = ["the", "a", "an"];
const LINKS: [&str; 5] = ["of", "is", "are", "with", "on"];
const MANNERS: [&str; 2] = ["framed", "oil"];
static OPENINGS: WordList = WordList::of(
    "there here this it show showing depict depicting display displaying feature featuring read reading say \
    saying",
);

/// The words of a text that only frame it.
#[derive(Clone, Debug)]
pub struct Frame {
    marks: Vec<bool>,
    /// Whether there is something in the frame: else its words are all that the text says.
    is_filled: bool,
}

impl Frame {
    /// Finds the frame of a text. `bare`: its words in lower case without diacritics. `after_break`: whether a comma or
    /// the like stands before a word.
    pub fn of(bare: &[&str], after_break: impl Fn(usize) -> bool) -> Frame {
        let stems: Vec<String> = bare.iter().map(|word| dictionary::stem(word)).collect();
        let words = Words { bare, stems: &stems, after_break: &after_break };
        let mut marks = vec![false; bare.len()];
        // From the end, for "a picture frame" is a frame by what follows it.
        for at in (0..bare.len()).rev() {
            marks[at] = is_noun(&stems[at]) && words.is_frame(at, marks.get(at + 1) == Some(&true));
        }
        let is_content = |stem: &str| stem.contains(char::is_alphanumeric) && !is_grammar(stem);
        let is_filled = marks.iter().zip(&stems).any(|(marked, stem)| !marked && is_content(stem));
        Frame { marks, is_filled }
    }

    /// Whether a word counts neither for nor against.
    pub fn leaves_out(&self, at: usize) -> bool {
        self.is_filled && self.marks[at]
    }

    /// Whether it introduces what a picture shows.
    pub fn is_of_picture(&self, bare: &[&str]) -> bool {
        let is_medium = |at: usize| MEDIA.has(&dictionary::stem(bare[at])) || bare[at] == "canvas";
        (0..bare.len()).any(|at| self.leaves_out(at) && is_medium(at))
    }

    /// Whether a word is of a frame with nothing in it, and so no more than generic.
    pub fn is_empty_at(&self, at: usize) -> bool {
        !self.is_filled && self.marks[at]
    }
}

/// Returns the words, as written, without the frame they begin and end with: what a proper name may open.
pub fn framed<'w, 't>(words: &'w [&'t str]) -> &'w [&'t str] {
    let bare: Vec<String> = words.iter().map(|word| bare(word)).collect();
    let bare: Vec<&str> = bare.iter().map(String::as_str).collect();
    let frame = Frame::of(&bare, |_| false);
    let frames = |at: usize| frame.leaves_out(at) || is_grammar(&dictionary::stem(bare[at]));
    let len = bare.len();
    let opening = (0..len).take_while(|at| frames(*at)).count();
    let closing = (opening..len).rev().take_while(|at| frames(*at)).count();
    let opens = |at: usize| frame.leaves_out(at) || OPENINGS.has(bare[at]);
    // What follows the link belongs to what is framed: "a picture of the Turing machine" names a Turing.
    let first = (0..opening).rev().find(|at| opens(*at)).map_or(0, |last| {
        let links: &[&str] = if frame.leaves_out(last) { &LINKS } else { &["is", "are"] };
        let is_linked = bare.get(last + 1).is_some_and(|next| links.contains(next));
        last + 1 + usize::from(is_linked && last + 1 < opening)
    });
    let end = if (len - closing..len).any(|at| frame.leaves_out(at)) { len - closing } else { len };
    &words[first..end]
}

struct Words<'t, F> {
    bare: &'t [&'t str],
    stems: &'t [String],
    after_break: &'t F,
}

impl<F: Fn(usize) -> bool> Words<'_, F> {
    fn is_frame(&self, at: usize, before_frame: bool) -> bool {
        // A plural, or a word that looks like one: "canvas".
        let stem = if self.bare[at] == "canvas" { "canvas" } else { self.stems[at].as_str() };
        let next = self.next(at);
        let in_grammar = next.is_none_or(|next| is_grammar(&self.stems[next]) && !self.is_label(next));
        match stem {
            _ if POSITIONS.has(stem) => in_grammar && self.is_position(at),
            "close" => next.is_some_and(|next| ["to", "up"].contains(&self.bare[next])),
            _ if MANNERS.contains(&stem) => before_frame || (stem == "oil" && self.is_on_canvas(at)),
            _ if MEDIA.has(stem) => in_grammar || before_frame,
            _ if CARRIERS.has(stem) => next.is_some_and(|next| READS.has(&self.stems[next])),
            _ if TEXTS.has(stem) => self.is_after_with(at) && !in_grammar,
            _ => false,
        }
    }

    fn next(&self, at: usize) -> Option<usize> {
        (at + 1 < self.bare.len() && !(self.after_break)(at + 1)).then_some(at + 1)
    }

    /// Returns the "no" of "painting no. 12".
    fn is_label(&self, at: usize) -> bool {
        role::is_number_label(self.bare[at]) && self.next(at).is_some()
    }

    fn is_position(&self, at: usize) -> bool {
        let before = |back: usize| at.checked_sub(back).map_or("", |at| self.bare[at]);
        let back = if ARTICLES.contains(&before(1)) { 2 } else { 1 };
        // "A painting of a wall" has a wall in it, "in front of a wall" only before it.
        PREPOSITIONS.contains(&before(back)) || (before(back) == "of" && before(back + 1) == "front")
    }

    fn is_after_with(&self, at: usize) -> bool {
        at > 0 && (ARTICLES.contains(&self.bare[at - 1]) || self.bare[at - 1] == "with")
    }

    fn is_on_canvas(&self, at: usize) -> bool {
        self.bare.get(at + 1) == Some(&"on") && self.bare.get(at + 2) == Some(&"canvas")
    }
}

/// Whether these words, in lower case without diacritics, begin with a position: "in front", "on the wall".
pub fn begins_position(bare: &[String]) -> bool {
    let mut words = bare.iter().map(String::as_str);
    let is_preposition = words.next().is_some_and(|word| PREPOSITIONS.contains(&word));
    is_preposition && words.find(|word| !ARTICLES.contains(word)).is_some_and(|word| POSITIONS.has(word))
}

/// Whether a word is left out of the judgement in a frame.
pub fn is_noun(stem: &str) -> bool {
    static NOUNS: LazyLock<HashSet<&str>> = LazyLock::new(|| {
        let lists = [&MEDIA, &CARRIERS, &TEXTS, &POSITIONS].into_iter().flat_map(WordList::iter);
        lists.chain(MANNERS).chain(["close", "canva"]).collect()
    });
    NOUNS.contains(stem)
}

/// Grammar says nothing, a "no" only of something else.
fn is_grammar(stem: &str) -> bool {
    misreading::class_of(stem) == Class::Function || dictionary::negates(stem)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn content(text: &str) -> String {
        let words: Vec<&str> = text.split(' ').collect();
        let frame = Frame::of(&words, |_| false);
        let is_kept = |at: usize| !frame.leaves_out(at) && !is_grammar(&dictionary::stem(words[at]));
        let kept = words.iter().enumerate().filter(|(at, _)| is_kept(*at));
        kept.map(|(_, word)| *word).collect::<Vec<_>>().join(" ")
    }

    #[test]
    fn a_frame_leaves_what_is_in_it() {
        for text in [
            "boat",
            "a picture of a boat",
            "a framed painting showing a boat",
            "an oil painting of a boat",
            "a boat painting",
            "a boat oil on canvas",
            "there is a boat in front of",
            "in the middle of the picture there is a boat",
            "a poster of a boat on the wall",
            "a sign that reads boat",
            "with the text boat",
            "a boat next to the wall in the background",
            "a boat in front of a wall",
        ] {
            assert_eq!(content(text), "boat", "{text}");
        }
    }

    #[test]
    fn a_noun_of_a_frame_counts_where_it_frames_nothing() {
        for (text, kept) in [
            ("a painting", "painting"),
            ("a framed picture on the wall", "framed picture wall"),
            ("photo booth", "photo booth"),
            ("painting 12", "painting 12"),
            ("painting no 12", "painting 12"),
            ("front desk", "front desk"),
            ("a sign with a red border", "sign red border"),
            ("no picture", "picture"),
            ("a painting of a wall", "wall"),
        ] {
            assert_eq!(content(text), kept, "{text}");
        }
    }

    #[test]
    fn a_name_is_sought_without_its_frame() {
        for (text, rest) in [
            ("A picture of Turing", "Turing"),
            ("A PICTURE OF THE MONA LISA", "THE MONA LISA"),
            ("There is Turing in front of", "Turing"),
            ("The Turing machine", "The Turing machine"),
            ("SHAPING THE NEXT GENERATION OF", "SHAPING THE NEXT GENERATION OF"),
            ("A painting", "A painting"),
        ] {
            let words: Vec<&str> = text.split(' ').collect();
            assert_eq!(framed(&words).join(" "), rest, "{text}");
        }
    }
}
