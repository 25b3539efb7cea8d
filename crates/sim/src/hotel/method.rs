//! Arms: the methods that run on the same data.

use serde_json::json;

use crate::api::settings::MapSettings;
use crate::named::named;

named! {
    /// A method of finding loops, with its name in tables.
    Method: &'static str {
        /// Revisit with its defaults.
        Ours = "ours", "Ours";
        /// The paper's exact method, with all of our extensions off, on ORB-SLAM3 (§III).
        Paper = "paper", "Paper's letter";
        /// Bag of words and Sim3 without anchors, as ORB-SLAM3 closes loops.
        BagOfWords = "bow", "BoW + Sim3";
        /// Revisit with its defaults, for a robot with one camera and no depth ([`super::sensing::monocular`]).
        OursMonocular = "monocular", "Ours monocular";
    }
}

impl Method {
    /// The arms for the paper's sequences, in the order of tables.
    pub const OF_SEQUENCES: [Self; 3] = [Self::Ours, Self::Paper, Self::BagOfWords];
    /// The arms for random worlds: bag of words with Sim3 fails in each of them.
    pub const OF_WORLDS: [Self; 3] = [Self::Ours, Self::OursMonocular, Self::Paper];

    /// Returns the settings of its map.
    pub fn settings(self) -> MapSettings {
        let settings = match self {
            Self::Ours | Self::OursMonocular => json!({}),
            Self::Paper => json!({"method": "paper"}),
            Self::BagOfWords => {
                json!({"method": "paper", "without_anchors": "geometry", "candidates_max": 3})
            }
        };
        MapSettings(settings.as_object().cloned().unwrap_or_default())
    }

    /// Whether its robot closes a loop only once it is confirmed as in ORB-SLAM3 ([`super::robot::common_regions`]).
    /// Ours closes every reported loop.
    pub fn confirms(self) -> bool {
        !matches!(self, Self::Ours | Self::OursMonocular)
    }

    /// Whether its robot has one camera and no depth, so that its unit of length is arbitrary.
    pub fn is_monocular(self) -> bool {
        self == Self::OursMonocular
    }

    /// Whether it uses signs.
    pub fn sees_signs(self) -> bool {
        self != Self::BagOfWords
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_arm_has_one_name_in_maps_and_in_results() {
        for arm in Method::OF_SEQUENCES.into_iter().chain(Method::OF_WORLDS) {
            assert_eq!(serde_json::to_value(arm).unwrap(), arm.as_str());
        }
    }
}
