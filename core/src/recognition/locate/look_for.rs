//! The signs that would tell one of several places from the others.

use crate::domain::ids::KeyframeSeq;
use crate::domain::location::LookFor;
use crate::geometry::Point3;
use crate::recognition::extensions::distinctiveness::PlaceCounts;
use crate::recognition::loops::anchor_map::{LocalAnchor, local_anchor_map};
use crate::recognition::loops::centre::Centre;
use crate::recognition::map::index::MapIndex;

/// Signs that are remembered of a place.
const NEARBY_MAX: usize = 3;
/// Signs that an answer names.
const NAMED_MAX: usize = 8;

/// A sign near a keyframe that bears an identifier and hangs in one place only.
#[derive(Clone, Debug, PartialEq)]
pub struct NearbySign {
    /// Its class.
    pub class: String,
    /// Its description.
    pub description: String,
    /// Its centre in the session's frame, in metres.
    pub position: Point3,
}

/// Returns the heaviest signs around a keyframe that bear an identifier and hang in one place only.
pub fn nearby_signs(index: &MapIndex, keyframe: KeyframeSeq, counts: &mut PlaceCounts) -> Vec<NearbySign> {
    let Some(centre) = Centre::stored(index, keyframe).filter(|_| !index.objects().is_empty()) else {
        return Vec::new();
    };
    let around = local_anchor_map(index, &centre, counts);
    let identifies =
        |anchor: &LocalAnchor| anchor.text.as_ref().is_some_and(|text| !text.identifiers().is_empty());
    let signs = around.heaviest(NEARBY_MAX, |anchor| anchor.places == 1 && identifies(anchor));
    signs
        .into_iter()
        .map(|anchor| NearbySign {
            class: anchor.class.to_string(),
            description: anchor.description.as_deref().unwrap_or_default().to_owned(),
            position: anchor.centre_in_session,
        })
        .collect()
}

/// Returns the signs of each of several places that none of the others has, those of the best place first.
pub fn telling_signs(places: &[(usize, &[NearbySign])]) -> Vec<LookFor> {
    let has = |signs: &[NearbySign], sign: &NearbySign| {
        signs.iter().any(|other| other.class == sign.class && other.description == sign.description)
    };
    let mut found = Vec::new();
    for (at, (place, signs)) in places.iter().enumerate() {
        let elsewhere = |sign: &NearbySign| {
            places.iter().enumerate().any(|(other, (_, signs))| other != at && has(signs, sign))
        };
        let telling = signs.iter().filter(|sign| !elsewhere(sign));
        found.extend(telling.map(|sign| LookFor {
            place: *place,
            class: sign.class.clone(),
            description: sign.description.clone(),
            position: sign.position,
        }));
    }
    found.truncate(NAMED_MAX);
    found
}
