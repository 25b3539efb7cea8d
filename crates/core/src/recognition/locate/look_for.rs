//! The signs that would tell one of several places from the others, of this question and of a loop query (M64).

use crate::domain::anchor::AnchorState;
use crate::domain::ids::KeyframeSeq;
use crate::domain::look_for::{LookFor, NearbySign};
use crate::recognition::extensions::distinctiveness::PlaceCounts;
use crate::recognition::map::index::{CELL_M, MapIndex};

/// Signs that are remembered of a place.
pub const NEARBY_MAX: usize = 12;
/// Signs that an answer names.
const NAMED_MAX: usize = 8;

/// Returns the signs within [`CELL_M`] of a keyframe that bear an identifier and hang in one place only, the nearest first.
pub fn nearby_signs(index: &MapIndex, keyframe: KeyframeSeq, counts: &mut PlaceCounts) -> Vec<NearbySign> {
    let Some(stored) = index.keyframe(keyframe) else { return Vec::new() };
    let centre = stored.map_from_camera.centre();
    let mut signs: Vec<(f64, NearbySign)> = Vec::new();
    for root in index.sign_grid().near(stored.session, &centre) {
        let Some(object) = index.objects().get(root).filter(|object| object.state == AnchorState::Valid)
        else {
            continue;
        };
        let Some((aabb, description)) = object.aabb(stored.session).zip(object.description.as_ref()) else {
            continue;
        };
        let apart_m = (aabb.centre() - centre).norm();
        if apart_m > CELL_M || !description.text.has_name() {
            continue;
        }
        if index.texts().of(root).is_some_and(|text| counts.of_text(index, text) == 1) {
            signs.push((
                apart_m,
                NearbySign {
                    class: index.class_of(object).to_owned(),
                    description: description.raw.to_string(),
                    position: aabb.centre(),
                },
            ));
        }
    }
    signs.sort_by(|(a, first), (b, second)| {
        a.total_cmp(b).then_with(|| first.description.cmp(&second.description))
    });
    signs.into_iter().take(NEARBY_MAX).map(|(_, sign)| sign).collect()
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
        found.extend(telling.map(|sign| LookFor { place: *place, sign: sign.clone() }));
    }
    found.truncate(NAMED_MAX);
    found
}
