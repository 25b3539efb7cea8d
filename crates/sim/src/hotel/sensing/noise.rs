//! Noise: disturbances that make a world harder than the paper's.

use crate::named::named;

named! {
    /// A kind of noise, by its name on the command line and its title in tables, in their order.
    NoiseKind: &'static str {
        /// None: the paper's worlds.
        None = "none", "nothing";
        /// The reader confuses characters, occasionally throughout a visit.
        Reader = "reader", "misread characters";
        /// Detections are missed, and some doors have no plate.
        Missed = "missed", "missed plates";
        /// Signs, paintings and numbers that hang everywhere.
        Repeated = "repeated", "repeated signs, paintings and numbers";
        /// Descriptions of one thing vary in wording.
        Wording = "wording", "other wording";
        /// Two robots, each with its own frame, in one map.
        Fleet = "fleet", "two robots";
        /// All of the above except the second robot.
        Mixed = "mixed", "all of it together";
        /// Door numbers change between rounds; not part of any headline figure.
        Renumbered = "renumbered", "new numbers on the doors";
        /// The second hotel: three identical-looking floors, the same prints on their walls, and a reader with realistic
        /// limits.
        SecondHotel = "v2", "hotel v2";
    }
}

impl NoiseKind {
    /// Each kind alone, and finally all combined.
    pub const TROUBLES: [Self; 6] =
        [Self::Reader, Self::Missed, Self::Repeated, Self::Wording, Self::Fleet, Self::Mixed];

    /// Returns its parameters.
    pub fn noise(self) -> Noise {
        let quiet = Noise::default();
        match self {
            Self::None | Self::Fleet | Self::Renumbered => quiet,
            Self::Reader => Noise { misread_share: 0.15, glare_share: 0.04, ..quiet },
            Self::Missed => Noise { missed_share: 0.35, no_plate_share: 0.1, ..quiet },
            Self::Repeated => Noise { repeated_signs: true, ..quiet },
            Self::Wording => Noise { other_wording: true, ..quiet },
            Self::SecondHotel => Noise { glare_share: 0.04, missed_share: 0.13, ocr: true, ..quiet },
            Self::Mixed => Noise {
                misread_share: 0.08,
                glare_share: 0.02,
                missed_share: 0.2,
                no_plate_share: 0.05,
                repeated_signs: true,
                other_wording: true,
                ocr: false,
            },
        }
    }
}

/// The parameters of the noise.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Noise {
    /// The share of readings with a wrong character.
    pub misread_share: f64,
    /// The share of plates that look like another number in a visit's light, for all readings of that visit.
    pub glare_share: f64,
    /// The share of detections that are missed.
    pub missed_share: f64,
    /// The share of doors without a plate.
    pub no_plate_share: f64,
    /// Whether signs, paintings and numbers repeat at every door.
    pub repeated_signs: bool,
    /// Whether descriptions vary in their wording.
    pub other_wording: bool,
    /// Whether text is read by an ordinary OCR ([`super::ocr`]), which does not distinguish classes of signs.
    pub ocr: bool,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_kind_has_one_name_on_the_command_line_and_in_results() {
        for kind in NoiseKind::ALL {
            assert_eq!(serde_json::to_value(kind).unwrap(), kind.as_str());
            assert_eq!(NoiseKind::from_name(kind.as_str()), Some(kind));
        }
    }
}
