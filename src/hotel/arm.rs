//! Arms: the methods that drive through the same data.

use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

/// A method of finding loops.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Arm {
    /// Revisit as it comes.
    Ours,
    /// The paper's method to the letter: every switch of ours off.
    Paper,
    /// Bag of words and Sim3 without anchors: ORB-SLAM3's candidates and its transformation, without its guided projections
    /// (50 and 80 matches) and without the three keyframes that must agree.
    #[serde(rename = "bow")]
    BagOfWords,
}

impl Arm {
    /// All of them, in the order of tables.
    pub const ALL: [Self; 3] = [Self::Ours, Self::Paper, Self::BagOfWords];

    /// A word for file names and map ids.
    pub fn name(self) -> &'static str {
        match self {
            Self::Ours => "ours",
            Self::Paper => "paper",
            Self::BagOfWords => "bow",
        }
    }

    /// What a table calls it.
    pub fn title(self) -> &'static str {
        match self {
            Self::Ours => "Ours",
            Self::Paper => "Paper's letter",
            Self::BagOfWords => "BoW + Sim3",
        }
    }

    /// The settings of its map.
    pub fn settings(self) -> Value {
        match self {
            Self::Ours => json!({}),
            Self::Paper => json!({"method": "paper"}),
            Self::BagOfWords => {
                json!({"without_anchors": "geometry", "candidates_max": 3, "aligned_anchors": false,
                    "odometry_max_drift_share": 0, "geometry_models": "sim3", "geometry_acceptance": "count", "rival_min_ratio": 0, "twin_guard": false, "geometry_resection": false,
                    "near_miss_neighbours": false, "neighbours_vouch": false})
            }
        }
    }

    /// Does it look at signs?
    pub fn sees_signs(self) -> bool {
        self != Self::BagOfWords
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_arm_has_one_name_in_maps_and_in_results() {
        for arm in Arm::ALL {
            assert_eq!(serde_json::to_value(arm).unwrap(), arm.name());
        }
    }
}
