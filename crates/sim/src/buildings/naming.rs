//! Ways to number doors, as real buildings do.

/// A way to number doors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Naming {
    /// `A 101`: wing, floor and door.
    LetterBlank,
    /// `B1.02`.
    LetterDot,
    /// `3-114A`: floor, door and wing.
    FloorDash,
    /// `914`: floor and door; wings go on counting.
    Plain,
    /// `ML D 28`: the building, the floor's letter, the door.
    FloorLetter,
    /// `H2 East 14`.
    Word,
    /// `三楼A区14号室`.
    Ideographs,
    /// `Γ.2.14`.
    Greek,
    /// `Zimmer 2.114`.
    Labelled,
}

/// Returns the letter of a wing or floor.
fn letter(number: usize) -> char {
    char::from(b'A' + (number % 26) as u8)
}

impl Naming {
    /// Returns the text on the plate of a door. No two doors of a building share one.
    pub fn plate(self, floor: usize, wing: usize, door: usize) -> String {
        const WORDS: [&str; 4] = ["East", "West", "North", "South"];
        const GREEK: [char; 4] = ['Α', 'Β', 'Γ', 'Δ'];
        const FLOORS: [char; 4] = ['一', '二', '三', '四'];
        let level = floor + 1;
        match self {
            Self::LetterBlank => format!("{} {level}{door:02}", letter(wing)),
            Self::LetterDot => format!("{}{level}.{door:02}", letter(wing)),
            Self::FloorDash => format!("{level}-1{door:02}{}", letter(wing)),
            Self::Plain => format!("{}", 100 * (level + 5) + 20 * wing + door),
            Self::FloorLetter => format!("ML {} {}", letter(3 + floor), 30 * wing + door),
            Self::Word => format!("H{level} {} {door}", WORDS[wing % 4]),
            Self::Ideographs => format!("{}楼{}区{door}号室", FLOORS[floor % 4], letter(wing)),
            Self::Greek => format!("{}.{level}.{door:02}", GREEK[wing % 4]),
            Self::Labelled => format!("Zimmer {level}.{}{door:02}", wing + 1),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn no_two_doors_of_a_building_share_a_plate() {
        for naming in [
            Naming::LetterBlank,
            Naming::LetterDot,
            Naming::FloorDash,
            Naming::Plain,
            Naming::FloorLetter,
            Naming::Word,
            Naming::Ideographs,
            Naming::Greek,
            Naming::Labelled,
        ] {
            let doors = (0..4).flat_map(|floor| (0..4).map(move |wing| (floor, wing)));
            let plates: Vec<String> = doors
                .flat_map(|(floor, wing)| (1..9).map(move |door| naming.plate(floor, wing, door)))
                .collect();
            assert_eq!(plates.iter().collect::<BTreeSet<_>>().len(), 128, "{naming:?}");
        }
    }
}
