//! Map points read: sets of their numbers, and their positions.

use std::collections::HashSet;
use std::hash::Hash;

use crate::api::decoding::read::{Decode, Node};
use crate::api::limits;
use crate::domain::ids::PointId;
use crate::geometry::Point3;

/// Returns a set of map points in the order in which the model keeps them.
pub(super) fn ascending(mut points: Vec<PointId>) -> Vec<PointId> {
    points.sort_unstable();
    points.dedup();
    points
}

/// Reads numbers and positions of map points, in parallel, and returns them ascending by number: the order in which a
/// client lists a set says nothing.
pub fn points(node: &Node<'_>) -> Option<Vec<(PointId, Point3)>> {
    let body = node.object(&["ids", "positions"])?;
    let ids =
        body.required("ids", |node| unique(node, limits::MAP_POINTS, |point| point.whole(limits::POINT)));
    let positions = body.required("positions", |node| node.list(limits::MAP_POINTS, Point3::decode));
    body.parallel("ids", "positions")?;
    let mut points: Vec<(PointId, Point3)> = ids?.into_iter().zip(positions?).collect();
    points.sort_unstable_by_key(|(id, _)| *id);
    Some(points)
}

/// Reads a list in which nothing may be twice; the second one is a fault.
pub fn unique<T: Clone + Eq + Hash>(
    node: &Node<'_>,
    max: usize,
    mut read: impl FnMut(&Node<'_>) -> Option<T>,
) -> Option<Vec<T>> {
    let mut seen = HashSet::new();
    node.list(max, |item| {
        let value = read(item)?;
        if seen.insert(value.clone()) { Some(value) } else { item.refuse("listed twice", "each one once") }
    })
}
