//! Company: a text beside which different signs hang, hangs in two places (M17).
//!
//! "HUB 04" hangs on the boards of floors 4 and 5, and where one board has plaque 4 beside it the other has plaque 5. Frames
//! of two sessions cannot be compared, so [`super::distinctiveness`] cannot tell two boards from one seen twice; the signs
//! beside them can. A neighbour is compared where it stands at the same offset from the text, with both views turned about
//! the camera's vertical axis until the text is straight ahead.

use std::collections::HashMap;
use std::rc::Rc;
use std::sync::Arc;

use nalgebra::Vector3;

use super::distinctiveness::PlaceCounts;
use crate::domain::anchor::AnchorState;
use crate::domain::ids::AnchorSeq;
use crate::recognition::loops::anchor_map::{LocalAnchor, LocalName, local_anchor_map};
use crate::recognition::loops::centre::Centre;
use crate::recognition::loops::equation_1::similar;
use crate::recognition::map::index::MapIndex;

/// Two offsets this near are one, in metres.
pub(in crate::recognition) const SAME_OFFSET_M: f64 = 1.0;
/// Neighbours of a text that are compared, the nearest first.
pub(in crate::recognition) const NEIGHBOURS_MAX: usize = 16;
/// Anchors of a text whose company is looked at, the oldest first.
pub(in crate::recognition) const CARRIERS_MAX: usize = 8;
/// A text right above or below the camera has no heading, in metres.
const LEAST_HORIZONTAL_M: f64 = 1e-3;

/// A numbered sign beside a text.
#[derive(Clone, Debug)]
struct Neighbour {
    sign: LocalAnchor,
    /// From the text, in metres, turned so that the text is straight ahead of the camera.
    offset: Vector3<f64>,
}

/// The company of the texts of one query; that of each stored anchor is found once.
#[derive(Debug, Default)]
pub struct Companies {
    of_stored: HashMap<AnchorSeq, Rc<Vec<Neighbour>>>,
}

impl Companies {
    /// Whether different signs hang beside two signs that are called alike, or beside others of that name. `maps` are the
    /// signs around the two.
    pub fn differs(
        &mut self,
        index: &MapIndex,
        pair: [&LocalAnchor; 2],
        maps: [&[Arc<LocalAnchor>]; 2],
        places: &mut PlaceCounts,
    ) -> bool {
        let [of_query, of_candidate] =
            [0, 1].map(|side| company(pair[side], maps[side].iter().map(Arc::as_ref)));
        // Beside the same sign it is the same text, whatever else hangs there or was misread.
        if agree(index, &of_query, &of_candidate) {
            return false;
        }
        if differ(index, &of_query, &of_candidate) {
            return true;
        }
        // Another view of the same two may show what these hide.
        let carriers = pair[1].text_id.map(|text| index.texts().objects(text).take(CARRIERS_MAX));
        let mut known = vec![Rc::new(of_query), Rc::new(of_candidate)];
        for root in carriers.into_iter().flatten() {
            let company = self.stored(index, root, places);
            if known.iter().any(|other| differ(index, other, &company)) {
                return true;
            }
            known.push(company);
        }
        false
    }

    /// Returns the company of a stored anchor, as its oldest keyframe sees it.
    fn stored(&mut self, index: &MapIndex, root: AnchorSeq, places: &mut PlaceCounts) -> Rc<Vec<Neighbour>> {
        if let Some(known) = self.of_stored.get(&root) {
            return known.clone();
        }
        let mut found = || {
            let oldest = index.keyframes_of(index.objects().get(root)?).first().copied()?;
            let map = local_anchor_map(index, &Centre::stored(index, oldest)?, places);
            let text = map.anchors.iter().find(|anchor| anchor.name == LocalName::MergedAnchor(root))?;
            Some(company(text, map.anchors.iter()))
        };
        let found = Rc::new(found().unwrap_or_default());
        self.of_stored.insert(root, found.clone());
        found
    }
}

/// Returns the numbered signs around a text, nearest first; none where its own place is a guess.
fn company<'a>(text: &LocalAnchor, around: impl Iterator<Item = &'a LocalAnchor>) -> Vec<Neighbour> {
    let at = text.centre_in_camera();
    if text.range_assumed || libm::hypot(at.x, at.z) < LEAST_HORIZONTAL_M {
        return Vec::new();
    }
    let (sin, cos) = libm::sincos(libm::atan2(at.x, at.z));
    let is_numbered = |anchor: &&LocalAnchor| {
        anchor.state == AnchorState::Valid
            && anchor.name != text.name
            && !anchor.range_assumed
            && anchor.text.as_ref().is_some_and(|text| text.has_name())
    };
    let from_text = |sign: &LocalAnchor| sign.centre_in_camera() - at;
    let mut signs: Vec<(f64, &LocalAnchor)> =
        around.filter(is_numbered).map(|sign| (from_text(sign).norm(), sign)).collect();
    signs.sort_by(|(a, x), (b, y)| a.total_cmp(b).then_with(|| x.name.cmp(&y.name)));
    let nearest = signs.into_iter().take(NEIGHBOURS_MAX).map(|(_, sign)| {
        let offset = from_text(sign);
        let across = cos.mul_add(offset.x, -sin * offset.z);
        let along = sin.mul_add(offset.x, cos * offset.z);
        Neighbour { sign: sign.clone(), offset: Vector3::new(across, offset.y, along) }
    });
    nearest.collect()
}

/// Whether a sign of one company differs from the one at its place in the other, and neither is anywhere in the other.
fn differ(index: &MapIndex, a: &[Neighbour], b: &[Neighbour]) -> bool {
    let is_in =
        |sign: &LocalAnchor, company: &[Neighbour]| company.iter().any(|n| alike(index, sign, &n.sign));
    pairs(a, b).any(|(x, y)| x.excludes(y) && !is_in(x, b) && !is_in(y, a))
}

/// Whether the same sign stands at the same place in both.
fn agree(index: &MapIndex, a: &[Neighbour], b: &[Neighbour]) -> bool {
    pairs(a, b).any(|(x, y)| alike(index, x, y))
}

/// Returns the pairs of signs at one offset.
fn pairs<'n>(
    a: &'n [Neighbour],
    b: &'n [Neighbour],
) -> impl Iterator<Item = (&'n LocalAnchor, &'n LocalAnchor)> {
    let all = a.iter().flat_map(move |x| b.iter().map(move |y| (x, y)));
    all.filter(|(x, y)| (x.offset - y.offset).norm() < SAME_OFFSET_M).map(|(x, y)| (&x.sign, &y.sign))
}

fn alike(index: &MapIndex, a: &LocalAnchor, b: &LocalAnchor) -> bool {
    similar(a, b, index.texts(), &index.properties().settings).is_some()
}
