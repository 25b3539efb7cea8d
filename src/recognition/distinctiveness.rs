//! How distinctive a description is: in how many places does it stand (`contract.md` §8.6)?
//!
//! The paper weighs an anchor by 1/d alone, so that an EXIT sign that hangs at every corner
//! speaks as loudly as a door number that hangs once; on generated hotels that drops precision to
//! 79 %. A description that stands in p places weighs 1/p. Places are counted within one
//! session's frame, since frames of different sessions cannot be compared; the largest count stands.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use super::index::{MapIndex, TextId};
use crate::geometry::Point3;
use crate::model::ids::{AnchorSeq, SessionSeq};

/// The counts of one query; each text is counted once.
#[derive(Debug, Default)]
pub struct PlaceCounts {
    by_text: HashMap<TextId, usize>,
}

impl PlaceCounts {
    /// In how many places objects stand that carry this text or one that matches it; at least 1.
    pub fn of_text(&mut self, index: &MapIndex, text: TextId) -> usize {
        *self.by_text.entry(text).or_insert_with(|| {
            let texts: Vec<TextId> = index.texts().matching(text).collect();
            count(index, &texts)
        })
    }

    /// The same for a text of which only the matching ones are in the map; at least 1.
    pub fn of_texts(&mut self, index: &MapIndex, texts: &[TextId]) -> usize {
        count(index, texts)
    }
}

fn count(index: &MapIndex, texts: &[TextId]) -> usize {
    let carriers: BTreeSet<AnchorSeq> = texts.iter().flat_map(|text| index.texts().objects(*text)).collect();
    let mut centres: BTreeMap<SessionSeq, Vec<Point3>> = BTreeMap::new();
    for object in carriers.into_iter().filter_map(|root| index.objects().get(root)) {
        for (session, shape) in &object.shapes {
            if let Some(aabb) = shape.aabb {
                centres.entry(*session).or_default().push(aabb.centre());
            }
        }
    }
    let radius_m = index.properties().settings.distinctive_place_radius_m;
    centres.values().map(|centres| places(centres, radius_m)).max().unwrap_or(1).max(1)
}

/// How many of the points lie more than `radius_m` apart, taken greedily in their order. Points are
/// sorted into cells as wide as the radius, so that each is held against its neighbourhood alone.
fn places(points: &[Point3], radius_m: f64) -> usize {
    if radius_m <= 0.0 {
        let distinct: BTreeSet<[u64; 3]> = points.iter().map(|p| [p.x, p.y, p.z].map(f64::to_bits)).collect();
        return distinct.len();
    }
    let mut cells: HashMap<[i64; 3], Vec<Point3>> = HashMap::new();
    let mut places = 0;
    for point in points {
        let cell = [point.x, point.y, point.z].map(|x| (x / radius_m).floor() as i64);
        let taken = neighbourhood(cell)
            .filter_map(|cell| cells.get(&cell))
            .flatten()
            .any(|place| (place - point).norm() <= radius_m);
        if !taken {
            cells.entry(cell).or_default().push(*point);
            places += 1;
        }
    }
    places
}

fn neighbourhood([x, y, z]: [i64; 3]) -> impl Iterator<Item = [i64; 3]> {
    let around = |at: i64| [at.saturating_sub(1), at, at.saturating_add(1)];
    around(x).into_iter().flat_map(move |x| {
        around(y).into_iter().flat_map(move |y| around(z).into_iter().map(move |z| [x, y, z]))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// By the letter: each point is held against every place.
    fn naive(points: &[Point3], radius_m: f64) -> usize {
        let mut places: Vec<Point3> = Vec::new();
        for point in points {
            if places.iter().all(|place| (place - point).norm() > radius_m) {
                places.push(*point);
            }
        }
        places.len()
    }

    proptest! {
        #[test]
        fn cells_change_no_count(points in prop::collection::vec(prop::array::uniform3(-20.0..20.0f64), 0..60), radius_m in 0.1..10.0f64) {
            let points: Vec<Point3> = points.into_iter().map(Point3::from).collect();
            prop_assert_eq!(places(&points, radius_m), naive(&points, radius_m));
        }
    }

    #[test]
    fn exactly_the_radius_apart_is_one_place() {
        let points = [[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [6.1, 0.0, 0.0]].map(Point3::from);
        assert_eq!(places(&points, 3.0), 2);
    }
}
