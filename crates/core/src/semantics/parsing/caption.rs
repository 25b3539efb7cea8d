//! Captions: sentences in which a model or a person puts what is to be seen (M24).
//!
//! Two models put one picture as "a framed picture showing a boat" and "there is a boat in front of a wall". The nouns of such a
//! sentence count only where it says nothing else, and of its words only those beside a number are known to be on a sign.

use crate::semantics::lexicon::dictionary::{self, Class};
use crate::semantics::lexicon::misreading;
use crate::semantics::lexicon::role;
use crate::semantics::lexicon::word_list::WordList;
use crate::semantics::parsing::context::Around;
use crate::semantics::parsing::normalise::bare;

/// Media of pictures.
static MEDIA: WordList = WordList::of(
    "picture painting photo photograph poster print image drawing artwork portrait canvas canva sketch illustration \
    depiction mural watercolor watercolour snapshot engraving etching fresco tapestry view scene closeup frame framed \
    bild gemalde foto tableau peinture affiche dessin cuadro pintura imagen quadro dipinto immagine schilderij afbeelding",
);

/// Carriers of a text, the text itself, and their places in the picture.
static NOUNS: WordList = WordList::of(
    "sign signage plate plaque label board panel placard notice text word inscription caption lettering \
    front back wall background foreground middle center centre distance top close oil",
);

/// Indefinite articles; "a" is one before a word.
static ARTICLES: WordList = WordList::of("an ein eine einen einem einer un une una uma een");

/// Words that captions have and signs hardly: what is said of letters. Beside other grammar they make a caption, as articles do.
static TELLING: WordList = WordList::of(
    "there showing saying displaying reading letters lettering characters digits text inscription",
);

/// Words between the beginning of a caption and its object.
static LINKS: WordList =
    WordList::of("of is are with on showing depicting displaying featuring reading saying");

/// Whether a text is a caption.
pub fn is_caption(around: &Around<'_>) -> bool {
    let opens = |at: usize, word: &String| {
        let next = around.bare.get(at + 1);
        let is_article = ARTICLES.has(word) || (word == "a" && around.is_before_word(at));
        is_article || TELLING.has(word) || (MEDIA.has(word) && next.is_some_and(|next| next == "of"))
    };
    let is_grammar = |word: &String| {
        dictionary::listed(word) == Some(Class::Function)
            && word.chars().nth(1).is_some()
            && !role::is_number_label(word)
            && !ARTICLES.has(word)
    };
    let words = || around.bare.iter().enumerate();
    let mut grammar = words().filter(|(_, word)| is_grammar(word)).map(|(at, _)| at);
    let (Some(first), more) = (grammar.next(), grammar.next()) else { return false };
    words().any(|(at, word)| (at != first || more.is_some()) && opens(at, word))
}

/// Whether a caption with these words tells what a picture shows.
pub fn is_of_picture(bare: &[String]) -> bool {
    bare.iter().any(|word| MEDIA.has(word))
}

/// Whether a noun is one of captions.
pub fn is_noun(stem: &str) -> bool {
    MEDIA.has(stem) || NOUNS.has(stem)
}

/// Returns the words, as written, without those with which a caption introduces and ends them: a proper name may open the rest.
pub fn introduced<'w, 't>(words: &'w [&'t str]) -> &'w [&'t str] {
    let introduces = |word: &&&str| {
        let stem = dictionary::stem(&bare(word));
        is_noun(&stem) || misreading::class_of(&stem) == Class::Function
    };
    let opening = words.iter().take_while(introduces).count();
    let link = words[..opening].iter().rposition(|word| LINKS.has(&bare(word)));
    let end = words.iter().rposition(|word| !introduces(&word)).map_or(words.len(), |last| last + 1);
    &words[link.map_or(0, |link| link + 1).min(end)..end]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::semantics::parsing::reading;
    use crate::semantics::parsing::token;

    #[test]
    fn a_caption_is_told_from_a_sign() {
        let is_caption = |text: &str| reading::read(&token::tokenise(text)).is_caption;
        for text in [
            "a picture of a boat",
            "a framed painting showing 901",
            "painting of 3 boats",
            "there is 901 in front of",
            "door number 901 in black letters",
            "ein schild mit der nummer 5",
        ] {
            assert!(is_caption(text), "{text}");
        }
        for text in
            ["reading room nord a 5", "photo booth", "painting 12", "a 101", "institut für mathematik 101"]
        {
            assert!(!is_caption(text), "{text}");
        }
    }

    #[test]
    fn a_name_is_sought_behind_what_introduces_it() {
        for (text, rest) in [
            ("A picture of Turing", "Turing"),
            ("There is Turing in front of", "Turing"),
            ("The Turing machine", "The Turing machine"),
            ("A painting", "A painting"),
        ] {
            let words: Vec<&str> = text.split(' ').collect();
            assert_eq!(introduced(&words).join(" "), rest, "{text}");
        }
    }
}
