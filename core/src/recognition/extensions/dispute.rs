//! Disputed readings: one plate that says floor 3 among plates that say floor 9 is a misread plate.
//!
//! Numbers with a separator begin with the part of the building they are in: "9.02" is on floor 9. Plates around one
//! keyframe share it, so a reading made once whose first part no other plate around it has, while some have another, is in
//! doubt. It may still be right at a border, so it needs a witness and is not left out (M25).

use std::collections::{BTreeMap, BTreeSet};

use crate::recognition::loops::anchor_map::{LocalAnchor, LocalAnchorMap, LocalName};
use crate::recognition::map::index::Certainty;

/// Returns the anchors of a local map whose reading is in doubt.
pub fn disputed(map: &LocalAnchorMap) -> BTreeSet<LocalName> {
    let mut around: BTreeMap<(&str, &str), usize> = BTreeMap::new();
    let mut of_class: BTreeMap<&str, usize> = BTreeMap::new();
    let plates = || map.anchors.iter().filter_map(|anchor| Some((anchor, part_of_building(anchor)?)));
    for (anchor, part) in plates() {
        *around.entry((&anchor.class, part)).or_default() += 1;
        *of_class.entry(&anchor.class).or_default() += 1;
    }
    let stands_alone = |anchor: &LocalAnchor, part: &str| {
        around.get(&(&*anchor.class, part)) == Some(&1) && of_class.get(&*anchor.class) > Some(&1)
    };
    let alone = plates()
        .filter(|(anchor, part)| anchor.certainty == Certainty::ReadOnce && stands_alone(anchor, part));
    alone.map(|(anchor, _)| anchor.name).collect()
}

/// Returns the first part of the number of a plate, if its number has several parts.
fn part_of_building(anchor: &LocalAnchor) -> Option<&str> {
    anchor.text.as_deref()?.names().next()?.first_part()
}
