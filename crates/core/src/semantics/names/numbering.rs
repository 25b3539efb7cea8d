//! Numbering: how one building names its doors, given by an operator or learned from what was read (M20).
//!
//! A reader finds numbers everywhere: railings, dates, plates cut by the frame. Once it is known how this building writes its
//! own ("7.04"), no other number names anything in it.

use std::collections::{BTreeMap, BTreeSet};

use crate::semantics::names::name::Name;
use crate::semantics::names::patterns::Patterns;
use crate::semantics::names::shape::Shape;

/// Number of values from which a shape is learned, each read alike in two keyframes or more.
pub const LEARNED_FROM_VALUES: usize = 10;
/// Number of values from which a shape is no accident, and numbers of other shapes with fewer values are in doubt.
pub const SHOWN_FROM_VALUES: usize = 3;
/// Marks between the names of a sign that lists several: "5.11/5.15".
const LIST_MARKS: [char; 3] = ['/', '-', ' '];
/// Ways in which the names of one building are written.
#[derive(Clone, Debug, Default)]
pub struct Numbering {
    /// Shapes of whole names. Empty as long as none is learned.
    shapes: BTreeSet<Shape>,
    /// Shapes that several values have; fewer values make a number of another shape doubtful.
    shown: BTreeSet<Shape>,
    patterns: Patterns,
    /// Whether every text is a code, to be compared exactly.
    is_of_codes: bool,
}

impl PartialEq for Numbering {
    fn eq(&self, other: &Self) -> bool {
        let told = |numbering: &Self| numbering.learned_or_given().map(str::to_owned).collect::<Vec<_>>();
        told(self) == told(other) && self.shown == other.shown && self.is_of_codes == other.is_of_codes
    }
}

/// Standing of a name in a building.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::semantics) enum Standing {
    /// A whole name, for all that is known.
    Whole,
    /// A number of a shape that nothing bears out yet, beside shapes that several names have.
    Doubtful,
    /// It lacks slots that most names fill: it may be any of those that have its parts.
    Partial,
    /// The number is none of the building's.
    Foreign,
}

impl Numbering {
    /// Learns from how many values of each shape were read alike in two keyframes or more; none while these are too few.
    ///
    /// A shape that is part of another one, which at least half of their values have, is what is left of cut plates.
    pub fn learned(established: &BTreeMap<Shape, usize>) -> Option<Self> {
        let from = |values: usize| {
            let holds = established.iter().filter(move |(_, count)| **count >= values);
            holds.map(|(shape, _)| shape.clone()).collect::<BTreeSet<Shape>>()
        };
        let (learned, shown) = (from(LEARNED_FROM_VALUES), from(SHOWN_FROM_VALUES));
        let is_cut = |part: &Shape| {
            learned.iter().any(|whole| part.is_part_of(whole) && established[whole] >= established[part])
        };
        let shapes: BTreeSet<Shape> = learned.iter().filter(|shape| !is_cut(shape)).cloned().collect();
        (!shown.is_empty()).then(|| Self { shapes, shown, ..Self::default() })
    }

    /// Takes an operator's regular expressions; a text that one of them matches whole, whatever its case, is an identifier.
    pub fn given(patterns: Patterns) -> Self {
        Self { patterns, ..Self::default() }
    }

    /// Returns the numbering of a class whose texts are codes.
    pub fn of_codes() -> Self {
        Self { is_of_codes: true, ..Self::default() }
    }

    /// Returns the patterns or learned shapes, as people are shown them.
    pub fn learned_or_given(&self) -> impl Iterator<Item = &str> {
        let given = self.patterns.texts().iter().map(String::as_str);
        given.chain(self.shapes.iter().map(Shape::as_str))
    }

    /// Whether every text is a code.
    pub(in crate::semantics) fn is_of_codes(&self) -> bool {
        self.is_of_codes
    }

    /// Whether an operator's pattern matches a whole text in normal form, which is then compared whole.
    pub(in crate::semantics) fn matches_whole(&self, normalised: &str) -> bool {
        self.patterns.match_whole(normalised)
    }

    /// Returns what a name is that no pattern matches.
    pub(in crate::semantics) fn standing(&self, name: &Name) -> Standing {
        if !self.patterns.is_empty() {
            return Standing::Foreign;
        }
        // Nothing is learned of names without digits: "Gate B".
        let Some(shape) = Shape::of(name) else { return Standing::Whole };
        let is_list = |shapes: &BTreeSet<Shape>| {
            LIST_MARKS.iter().any(|mark| shape.listed(*mark).all(|one| shapes.contains(&one)))
        };
        let holds = |shapes: &BTreeSet<Shape>| is_list(shapes) || shapes.iter().any(|own| shape.extends(own));
        let is_part = |shapes: &BTreeSet<Shape>| shapes.iter().any(|own| shape.is_part_of(own));
        match () {
            () if holds(&self.shapes) => Standing::Whole,
            () if is_part(&self.shapes) => Standing::Partial,
            () if !self.shapes.is_empty() => Standing::Foreign,
            () if self.shown.is_empty() || holds(&self.shown) => Standing::Whole,
            () => Standing::Doubtful,
        }
    }

    /// Whether it tells whole names from parts of them.
    pub fn tells_parts(&self) -> bool {
        !self.shapes.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::semantics::{Text, TextKind, conflict, similarity};

    fn numbering(shapes: &[(&str, usize)]) -> Option<Numbering> {
        let of = |value: &str| Text::parse(value).shape().expect("digits");
        Numbering::learned(&shapes.iter().map(|(value, count)| (of(value), *count)).collect())
    }

    #[test]
    fn ten_values_make_a_numbering_and_what_is_left_of_cut_plates_makes_none() {
        let shown = |shapes: &[(&str, usize)]| -> Vec<String> {
            numbering(shapes).iter().flat_map(Numbering::learned_or_given).map(str::to_owned).collect()
        };
        for (shapes, expected) in [
            (&[("7.04", 9), ("901", 9)][..], &[][..]),
            (&[("7.04", 9), ("901", 10)], &["#"]),
            (&[("7.04", 10), ("901", 10)], &["#.99"]),
            (&[("7.04", 10), ("901", 11)], &["#", "#.99"]),
            (&[("7.04", 20), ("1-03", 12), ("901", 14)], &["#-99", "#.99"]),
            (&[("ML D 28", 30), ("D 28", 11), ("28", 12)], &["Aa A #"]),
        ] {
            assert_eq!(shown(shapes), expected, "{shapes:?}");
        }
        assert_eq!(numbering(&[("7.04", 2), ("901", 2)]), None);
    }

    #[test]
    fn what_lacks_parts_of_a_numbering_neither_matches_nor_contradicts() {
        let numbering = numbering(&[("ML D 28", 10)]);
        let parse = |text: &str| Text::under(text, numbering.as_ref());
        let level = |a: &str, b: &str| similarity(&parse(a), &parse(b)).level;
        assert_eq!((level("ML D 28", "ml d 28"), level("ML D 28", "ML E 28")), (5, 1));
        for (a, b) in [("28", "28"), ("D 28", "D 28"), ("28", "ML D 28"), ("D 28", "ML E 28"), ("28", "29")] {
            assert!(level(a, b) <= 3, "{a} | {b}");
        }
        assert!(conflict(&parse("28"), &parse("ML D 28")).is_none());
        for (text, shape) in [("5.11/5.15", "7.04"), ("5.11-5.15", "7.04"), ("901 902", "901")] {
            let listed = self::numbering(&[(shape, 10)]);
            assert_eq!(
                Text::under(text, listed.as_ref()).kind(),
                TextKind::Name,
                "{text} lists names like {shape}"
            );
        }
        assert!(parse("28").is_partial() && !parse("Kitchen ML D 28").is_partial());
        // What is no number of the building says nothing of another, and is still a difference.
        for text in ["7.04", "HUB 4.1"] {
            assert_eq!(parse(text).information_level() == 1, text == "7.04", "{text}");
            assert!(conflict(&parse(text), &parse("ML D 28")).is_none(), "{text}");
        }
        assert!(level("Turing 1.2", "Turing 1.4") < 4);
        assert!(parse("Level 5").has_name(), "a container stays one");
    }

    #[test]
    fn a_number_of_a_shape_that_others_bear_out_is_a_name_and_beside_them_another_is_in_doubt() {
        let young = numbering(&[("7.04", 3), ("901", 2)]);
        let kind = |text: &str| Text::under(text, young.as_ref()).kind();
        assert_eq!(
            (kind("8.01"), kind("901"), kind("Lab 8.01")),
            (TextKind::Name, TextKind::Unknown, TextKind::Name)
        );
        assert_eq!(Text::parse("901").kind(), TextKind::Name);
    }

    #[test]
    fn an_operators_pattern_matches_a_whole_text() {
        let patterns = [r"\d{1,2}\.\d\d".to_owned(), "hub ?[0-9]+".to_owned()];
        let numbering = Numbering::given(Patterns::new(patterns.to_vec()).expect("two patterns"));
        let parse = |text: &str| Text::under(text, Some(&numbering));
        for (text, is_one) in [
            ("7.04", true),
            ("HUB04", true),
            ("Hub 4", true),
            ("room 7.04", false),
            ("302", false),
            ("9F", false),
        ] {
            assert_eq!(parse(text).has_own_name(), is_one, "{text}");
        }
        assert_eq!(numbering.learned_or_given().collect::<Vec<_>>(), patterns);
    }
}
