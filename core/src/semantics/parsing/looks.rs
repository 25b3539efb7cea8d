//! Looks: the colour, material and number that a text states of a thing.
//!
//! "A bridge at a glass vase" and "a bridge at a blue vase" have most words in common, and are two pictures.

use crate::semantics::lexicon::dictionary::Class;
use crate::semantics::lexicon::misreading;
use crate::semantics::parsing::reading::{Mention, What};
use crate::semantics::parsing::token::Token;

/// The things of a text with a look of each, sorted, without duplicates.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct Looks(Vec<(String, String)>);

impl Looks {
    /// Collects the looks that stand right before a noun: the "blue" and "white" of "a blue and white vase".
    pub fn among(mentions: &[Mention], tokens: &[Token<'_>]) -> Looks {
        let mut found = Vec::new();
        let mut before: Vec<&str> = Vec::new();
        let mut end = 0;
        for mention in mentions {
            let linked = mention.first == end || (mention.first == end + 1 && tokens[end].text == "and");
            if !linked || tokens[mention.first].after_break {
                before.clear();
            }
            end = mention.end;
            match &mention.what {
                What::Word { word, .. } if misreading::is_look(&word.text) => before.push(look(&word.text)),
                What::Word { word, .. } if word.class == Class::Descriptive => {}
                What::Word { word, .. } if word.class != Class::Quantity => {
                    found.extend(before.drain(..).map(|look| (word.text.clone(), look.to_owned())));
                }
                _ => before.clear(),
            }
        }
        found.sort_unstable();
        found.dedup();
        Looks(found)
    }

    /// Keeps the looks of some things only.
    pub fn of(&self, is_kept: impl Fn(&str) -> bool) -> Looks {
        Looks(self.0.iter().filter(|(thing, _)| is_kept(thing)).cloned().collect())
    }

    /// Returns the thing of which both texts state a look, and none alike.
    pub fn clash<'l>(&'l self, other: &Looks) -> Option<&'l str> {
        let is_of = |thing: &str, looks: &Looks| looks.0.iter().any(|(other, _)| other == thing);
        let agrees =
            |thing: &str| self.0.iter().any(|look| look.0 == thing && other.0.binary_search(look).is_ok());
        self.0.iter().map(|(thing, _)| thing.as_str()).find(|thing| is_of(thing, other) && !agrees(thing))
    }
}

/// One spelling of a look: wood is wooden.
fn look(stem: &str) -> &str {
    match stem {
        "wooden" => "wood",
        "metallic" => "metal",
        "golden" => "gold",
        "gray" => "grey",
        other => other,
    }
}

#[cfg(test)]
mod tests {
    use crate::semantics::Text;

    #[test]
    fn looks_clash_where_both_texts_state_one_of_the_same_thing() {
        for (a, b, thing) in [
            ("a glass vase", "a blue vase", Some("vase")),
            ("a blue and white vase", "a white vase", None),
            ("a blue glass vase", "a glass vase", None),
            ("a glass vase", "a vase", None),
            ("a wooden bridge", "a wood bridge", None),
            ("a gray cat", "a grey cat", None),
            ("a red boat, blue lake", "a blue boat, red lake", Some("boat")),
            ("two old boats", "three boats", Some("boat")),
            ("a glass, vase", "a blue vase", None),
        ] {
            let (a, b) = (Text::parse(a), Text::parse(b));
            assert_eq!(a.looks.clash(&b.looks), thing, "{a:?}");
            assert_eq!(b.looks.clash(&a.looks), thing, "{b:?}");
        }
    }
}
