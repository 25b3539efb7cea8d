//! Methods: settings that belong together, under one name.

use super::settings::{SettingValue, Settings};

/// The settings that make a map follow a method.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Revisit's: the defaults.
    Revisit,
    /// The paper's, to the letter: every switch of ours off.
    Paper,
}

/// Each setting of ours with its value in the paper's method.
const PAPER: [(&str, SettingValue); 22] = [
    ("anchor_map_min_similarity", SettingValue::Number(0.3)),
    ("one_to_one", SettingValue::Switch(false)),
    ("distinctive_weights", SettingValue::Switch(false)),
    ("contradiction_veto", SettingValue::Switch(false)),
    ("aligned_anchors", SettingValue::Switch(false)),
    ("reading_min_confidence", SettingValue::Number(0.0)),
    ("identifier_patterns", SettingValue::Patterns(Vec::new())),
    ("learned_identifiers", SettingValue::Switch(false)),
    ("company", SettingValue::Switch(false)),
    ("odometry_max_drift_share", SettingValue::Number(0.0)),
    ("tracked_loops_need_geometry", SettingValue::Switch(false)),
    ("single_text_needs_witness", SettingValue::Switch(false)),
    ("near_miss_neighbours", SettingValue::Switch(false)),
    ("neighbours_vouch", SettingValue::Switch(false)),
    ("undecided_min_score_ratio", SettingValue::Number(0.0)),
    ("rival_min_ratio", SettingValue::Number(0.0)),
    ("twin_guard", SettingValue::Switch(false)),
    ("signs_may_change", SettingValue::Switch(false)),
    ("geometry_landmark_sigma_px", SettingValue::Number(0.0)),
    ("geometry_resection", SettingValue::Switch(false)),
    ("geometry_models", SettingValue::Choice("sim3")),
    ("geometry_acceptance", SettingValue::Choice("count")),
];

impl Method {
    /// The names in the API document.
    pub const NAMES: [&'static str; 2] = ["revisit", "paper"];

    /// The method of a name.
    pub fn from_name(name: &str) -> Option<Self> {
        match name {
            "revisit" => Some(Self::Revisit),
            "paper" => Some(Self::Paper),
            _ => None,
        }
    }

    /// The settings that tell the methods apart, with their values in this one.
    pub fn settings(self) -> impl Iterator<Item = (&'static str, SettingValue)> {
        let defaults = Settings::default();
        PAPER.into_iter().map(move |(name, paper)| match self {
            Self::Paper => (name, paper),
            Self::Revisit => (name, defaults.get(name).unwrap_or(paper)),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_method_names_settings_that_there_are_and_every_switch_is_one_of_ours() {
        let mut settings = Settings::default();
        for (name, value) in Method::Paper.settings() {
            assert_eq!(settings.set(name, value), Ok(()), "{name}");
        }
        for row in Settings::TABLE {
            let is_on = settings.get(row.name) == Some(SettingValue::Switch(true));
            // What is kept decides nothing.
            assert!(!is_on || row.name.starts_with("keep_"), "{} is not the paper's", row.name);
        }
        for (name, value) in Method::Revisit.settings() {
            assert_eq!(settings.set(name, value), Ok(()), "{name}");
        }
        assert_eq!(settings, Settings::default());
    }
}
