//! Map points read: sets of their numbers, and their positions.

use std::collections::HashSet;
use std::hash::Hash;

use crate::api::decoding::column::{Column, Number};
use crate::api::decoding::read::{Decode, Node};
use crate::api::limits;
use crate::domain::ids::PointId;
use crate::geometry::Point3;

const IDS: Column = Column { list: "ids", packed: "ids_i64", number: Number::I64, row: None };
const POSITIONS: Column =
    Column { list: "positions", packed: "positions_f64", number: Number::F64, row: Some(3) };

/// Returns a set of map points in the order in which the model keeps them.
pub(in crate::api) fn ascending(mut points: Vec<PointId>) -> Vec<PointId> {
    points.sort_unstable();
    points.dedup();
    points
}

/// Reads numbers and positions of map points, in parallel, and returns them ascending by number: the order in which a
/// client lists a set says nothing.
pub fn points(node: &Node<'_>) -> Option<Vec<(PointId, Point3)>> {
    let body = node.object(&[IDS.list, IDS.packed, POSITIONS.list, POSITIONS.packed])?;
    let ids = body
        .required_column(IDS, |node| unique(node, limits::MAP_POINTS, |point| point.whole(limits::POINT)));
    let positions = body.required_column(POSITIONS, |node| node.list(limits::MAP_POINTS, Point3::decode));
    body.parallel_columns(IDS, POSITIONS)?;
    let mut points: Vec<(PointId, Point3)> = ids?.into_iter().zip(positions?).collect();
    points.sort_unstable_by_key(|(id, _)| *id);
    Some(points)
}

/// Reads a list in which nothing may be twice; the second one is a fault.
pub fn unique<T: Clone + Ord + Hash>(
    node: &Node<'_>,
    max: usize,
    mut read: impl FnMut(&Node<'_>) -> Option<T>,
) -> Option<Vec<T>> {
    let mut list: Vec<T> = Vec::with_capacity(node.value().len().min(max));
    // Ascending lists, which is what most clients send, need no set.
    let mut seen = None;
    node.each(max, |_, item| {
        let value = read(item)?;
        if seen.is_some() || list.last().is_some_and(|last| *last >= value) {
            let seen = seen.get_or_insert_with(|| list.iter().cloned().collect::<HashSet<T>>());
            if !seen.insert(value.clone()) {
                return item.refuse("listed twice", "each one once");
            }
        }
        list.push(value);
        Some(())
    })?;
    Some(list)
}
