//! Shapes: how the names of one building are written, slot by slot (M20).

use crate::semantics::names::name::{Name, PartKind};

/// The way a name is written: `A` is a letter, `Aa` a word, and digits stand in groups with the marks between them.
///
/// `#` is the first group, of any length, for it counts floors or all rooms. Every other group keeps its length: "7.04" and
/// "10.01" are both `#.99`, and "ML D 28" is `Aa A #`.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Shape(Box<str>);

impl Shape {
    /// Returns the shape of a name; none if it has no digits.
    pub fn of(name: &Name) -> Option<Self> {
        let mut shape = String::new();
        let mut words = name.parts().iter().filter(|part| part.kind != PartKind::Digits);
        let mut last = ' ';
        for c in name.spelt().chars() {
            match c {
                '0'..='9' if !shape.contains('#') => shape.push('#'),
                '0'..='9' if last.is_ascii_digit() && shape.ends_with('#') => {}
                '0'..='9' => shape.push('9'),
                _ if !c.is_alphanumeric() => shape.push(c),
                _ if last.is_alphabetic() => {}
                _ => {
                    let is_letter = words.next().is_some_and(|part| part.kind == PartKind::Letter);
                    shape.push_str(if is_letter { "A" } else { "Aa" });
                }
            }
            last = c;
        }
        shape.contains('#').then(|| Self(shape.into()))
    }

    /// As people are shown it: `#.99`.
    pub fn as_str(&self) -> &str {
        &self.0
    }

    /// Returns the slots: letters, words and groups of digits.
    fn slots(&self) -> impl Iterator<Item = &str> {
        self.0.split(|c: char| !c.is_alphanumeric() && c != '#').filter(|slot| !slot.is_empty())
    }

    fn digits(&self) -> impl Iterator<Item = &str> {
        self.slots().filter(|slot| slot.starts_with(['#', '9']))
    }

    /// Whether it lacks slots that another shape has, and has no other: what is left of a plate that was cut.
    pub fn is_part_of(&self, other: &Self) -> bool {
        let mut rest = other.slots();
        let fits = |slot: &str, whole: &str| slot == whole || (slot == "#" && whole.starts_with('9'));
        self.slots().count() < other.slots().count()
            && self.slots().all(|slot| rest.any(|whole| fits(slot, whole)))
    }

    /// Returns the shapes of the names that it lists, if a mark parts it so: `#.99` twice for `#.99/9.99`.
    pub fn listed(&self, mark: char) -> impl Iterator<Item = Shape> + '_ {
        self.0.split(mark).map(|one| {
            let first = one.find('9').filter(|_| !one.contains('#'));
            let rest = |at: usize| one[at..].trim_start_matches('9');
            Shape(first.map_or_else(|| one.to_owned(), |at| format!("{}#{}", &one[..at], rest(at))).into())
        })
    }

    /// Whether it has the slots of another shape, its digits as that writes them, and letters or words besides.
    pub fn extends(&self, other: &Self) -> bool {
        other.is_part_of(self) && other.digits().eq(self.digits())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::semantics::Text;

    fn shape(text: &str) -> Option<Shape> {
        Text::parse(text).shape()
    }

    #[test]
    fn a_shape_has_every_slot_and_the_length_of_every_group_but_the_first() {
        for (text, expected) in [
            ("7.04", "#.99"),
            ("10.01", "#.99"),
            ("901", "#"),
            ("1-03", "#-99"),
            ("8.0", "#.9"),
            ("ML D 28", "Aa A #"),
            ("B1-3", "A #-9"),
            ("3-114A", "#-999 A"),
            ("HUB10", "Aa #"),
            ("Room 901", "#"),
        ] {
            assert_eq!(shape(text).expect("a number").as_str(), expected, "{text}");
        }
        for text in ["", "Gate B", "EXIT"] {
            assert_eq!(shape(text), None, "{text}");
        }
    }

    #[test]
    fn a_plate_that_was_cut_has_part_of_the_shape() {
        let is_part =
            |part: &str, whole: &str| shape(part).expect("digits").is_part_of(&shape(whole).expect("digits"));
        for (part, whole) in [("28", "ML D 28"), ("D 28", "ML D 28"), ("114", "3-114A"), ("302", "3.02")] {
            assert!(is_part(part, whole), "{part} of {whole}");
            assert!(!is_part(whole, part), "{whole} of {part}");
        }
        for (other, whole) in [("HUB 4", "3.02"), ("A 28", "28"), ("3.02", "4.02")] {
            assert!(!is_part(other, whole), "{other} of {whole}");
        }
    }
}
