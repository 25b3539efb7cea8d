//! Arms: the methods that run on the same data.

use serde::{Deserialize, Serialize};
use serde_json::json;

use crate::api::settings::MapSettings;

/// A method of finding loops.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Method {
    /// Revisit with its defaults.
    Ours,
    /// The paper's exact method, with all of our extensions off, on ORB-SLAM3 (§III).
    Paper,
    /// Bag of words and Sim3 without anchors, as ORB-SLAM3 closes loops.
    #[serde(rename = "bow")]
    BagOfWords,
    /// Revisit with its defaults, for a robot with one camera and no depth ([`super::sensing::monocular`]).
    #[serde(rename = "monocular")]
    OursMonocular,
}

impl Method {
    /// The arms for the paper's sequences, in the order of tables.
    pub const OF_SEQUENCES: [Self; 3] = [Self::Ours, Self::Paper, Self::BagOfWords];
    /// The arms for random worlds: bag of words with Sim3 fails in each of them.
    pub const OF_WORLDS: [Self; 3] = [Self::Ours, Self::OursMonocular, Self::Paper];

    /// Returns the name for files and map ids.
    pub fn name(self) -> &'static str {
        match self {
            Self::Ours => "ours",
            Self::Paper => "paper",
            Self::BagOfWords => "bow",
            Self::OursMonocular => "monocular",
        }
    }

    /// Returns the name in tables.
    pub fn title(self) -> &'static str {
        match self {
            Self::Ours => "Ours",
            Self::Paper => "Paper's letter",
            Self::BagOfWords => "BoW + Sim3",
            Self::OursMonocular => "Ours monocular",
        }
    }

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
            assert_eq!(serde_json::to_value(arm).unwrap(), arm.name());
        }
    }
}
