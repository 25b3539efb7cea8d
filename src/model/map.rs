//! A map: what one building's robots share.

use super::settings::Settings;

/// What a client says of a map.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MapProperties {
    /// Free text for people.
    pub description: String,
    /// Are its lengths metres? If so, the scale between two sessions is 1.
    pub metric: bool,
    /// The classes of which anchors are made, sorted; empty means every class.
    pub anchor_classes: Vec<String>,
    /// Every threshold of the method.
    pub settings: Settings,
}

impl MapProperties {
    /// Are detections of this class semantic anchors here (§III: predefined categories)?
    pub fn anchors_class(&self, class: &str) -> bool {
        self.anchor_classes.is_empty() || self.anchor_classes.iter().any(|c| c == class)
    }
}
