//! Kinds of buildings: each has one property that deceives place recognition.

use super::naming::Naming;
use crate::named::{Named as _, named};

named! {
    /// A kind of building: the first half are for tuning, the others for reporting only.
    Kind {
        /// Wings that one letter or word of a plate tells apart.
        Wings = "wings",
        /// The same notices, in several languages, at many doors.
        Notices = "notices",
        /// Billboards across the street, which every floor sees through its windows.
        Windows = "windows",
        /// Wings that look alike.
        CopiedWings = "copied_wings",
        /// The same six pictures on the walls of all rooms, in which sessions begin.
        Pictures = "pictures",
        /// A reader that misreads one character of a plate for a whole passage.
        Misread = "misread",
        /// A lift between two floors, which odometry does not see.
        Lift = "lift",
        /// Clients that send poses and detections alone.
        Bare = "bare",
        /// Floors that one letter of a plate tells apart, under a poor reader.
        FloorLetters = "floor_letters",
        /// The same brands and names at many doors.
        Brands = "brands",
        /// Pointers and directories, which name places elsewhere.
        Directories = "directories",
        /// Wings that are mirror images of each other.
        MirroredWings = "mirrored_wings",
        /// A reader that reads railings as numbers.
        Railings = "railings",
        /// Sessions that begin in rooms that look alike.
        ClonedStarts = "cloned_starts",
        /// Robots whose lengths drift.
        Stretched = "stretched",
        /// Photographs without positions.
        Photographs = "photographs",
    }
}

/// The likeness of a building's wings and floors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Look {
    /// Each its own way.
    Own,
    /// Alike.
    Copied,
    /// Every other one is a mirror image.
    Mirrored,
}

/// The data that a client sends besides detections.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Client {
    /// Features with map points, by a depth camera.
    Depth,
    /// Poses alone.
    Bare,
    /// Features without points, poses without positions.
    Photographs,
}

/// Things that may hang in a building besides plates and common signs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extra {
    /// Notices at doors.
    Notices,
    /// Brands at doors.
    Brands,
    /// Pictures in corridors.
    Pictures,
    /// Billboards seen through windows.
    Billboards,
    /// Pointers and directories.
    Directories,
}

/// The traits of a kind of building.
#[derive(Clone, Debug)]
pub struct Traits {
    /// Ways to number doors; the seed draws one.
    pub naming: &'static [Naming],
    /// Wings of a floor.
    pub wings: usize,
    /// Floors.
    pub floors: usize,
    /// Their likeness.
    pub look: Look,
    /// Things that hang there besides plates and common signs.
    pub hangs: &'static [Extra],
    /// The share of readings with a wrong or missing character.
    pub misread: f64,
    /// The share of plates that a passage reads with one wrong character throughout.
    pub misread_passage: f64,
    /// The share of keyframes in which a railing is read.
    pub railings: f64,
    /// Whether sessions begin in a room.
    pub starts_in_room: bool,
    /// Whether a session takes the lift from one floor to another.
    pub lift: bool,
    /// By how much lengths drift over a session.
    pub stretch: f64,
    /// The data that clients send.
    pub client: Client,
}

const TUNED: &[Naming] = &[Naming::LetterBlank, Naming::LetterDot, Naming::FloorDash, Naming::Plain];
const REPORTED: &[Naming] =
    &[Naming::FloorLetter, Naming::Word, Naming::Ideographs, Naming::Greek, Naming::Labelled];

impl Kind {
    const HALVES: (&[Self], &[Self]) = Self::VALUES.split_at(8);
    /// The kinds for tuning and inspection.
    pub const TUNING: &[Self] = Self::HALVES.0;
    /// The kinds for reporting only.
    pub const HELD_OUT: &[Self] = Self::HALVES.1;

    /// Whether it is for reporting only.
    pub fn is_held_out(self) -> bool {
        Self::HELD_OUT.contains(&self)
    }

    /// Returns what a building of the kind has.
    pub fn traits(self) -> Traits {
        let plain = Traits {
            naming: if self.is_held_out() { REPORTED } else { TUNED },
            wings: 1,
            floors: 4,
            look: Look::Copied,
            hangs: &[],
            misread: 0.04,
            misread_passage: 0.0,
            railings: 0.0,
            starts_in_room: false,
            lift: false,
            stretch: 0.0,
            client: Client::Depth,
        };
        match self {
            Self::Wings => Traits { wings: 4, floors: 1, look: Look::Own, ..plain },
            Self::Notices => Traits { hangs: &[Extra::Notices], look: Look::Own, ..plain },
            Self::Windows => Traits { hangs: &[Extra::Billboards], ..plain },
            Self::CopiedWings => Traits { wings: 4, floors: 1, hangs: &[Extra::Pictures], ..plain },
            Self::Pictures => Traits { hangs: &[Extra::Pictures], starts_in_room: true, ..plain },
            Self::Misread => Traits { misread_passage: 0.15, ..plain },
            Self::Lift => Traits { lift: true, ..plain },
            Self::Bare => Traits { client: Client::Bare, hangs: &[Extra::Notices], look: Look::Own, ..plain },
            Self::FloorLetters => Traits { misread: 0.15, naming: &REPORTED[..1], ..plain },
            Self::Brands => Traits { hangs: &[Extra::Brands], look: Look::Own, ..plain },
            Self::Directories => Traits { hangs: &[Extra::Directories], ..plain },
            Self::MirroredWings => Traits { wings: 4, floors: 1, look: Look::Mirrored, ..plain },
            Self::Railings => Traits { railings: 0.3, ..plain },
            Self::ClonedStarts => Traits { starts_in_room: true, ..plain },
            Self::Stretched => Traits { stretch: 0.12, ..plain },
            Self::Photographs => Traits { client: Client::Photographs, hangs: &[Extra::Billboards], ..plain },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_kind_for_reporting_numbers_doors_as_kinds_for_tuning_do() {
        for kind in Kind::HELD_OUT {
            assert!(kind.is_held_out() && !Kind::TUNING.contains(kind));
            assert_eq!(Kind::from_name(kind.as_str()), Some(*kind));
            assert!(!kind.traits().naming.iter().any(|naming| TUNED.contains(naming)), "{}", kind.as_str());
        }
    }
}
