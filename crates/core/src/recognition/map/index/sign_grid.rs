//! The signs of a session by place: which of them are near a camera, whatever that camera has seen.

use std::collections::{BTreeMap, BTreeSet};

use super::objects::MergedAnchor;
use super::reverse::remove_last;
use crate::domain::ids::{AnchorSeq, SessionSeq};
use crate::geometry::Point3;

/// The side of a cell, in metres.
pub const CELL_M: f64 = 10.0;

type Cell = (SessionSeq, [i64; 3]);

/// The objects of a map, by session and cell of their centre.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SignGrid {
    by_cell: BTreeMap<Cell, BTreeSet<AnchorSeq>>,
    cells_of: BTreeMap<AnchorSeq, Vec<Cell>>,
}

impl SignGrid {
    /// Returns the objects of a session within [`CELL_M`] of a place, and some beyond, ascending.
    pub fn near(&self, session: SessionSeq, place: &Point3) -> BTreeSet<AnchorSeq> {
        let [x, y, z] = coordinates(place);
        let around = |at: i64| [at.saturating_sub(1), at, at.saturating_add(1)];
        let cells = around(x)
            .into_iter()
            .flat_map(move |x| around(y).map(|y| [x, y, z]))
            .flat_map(move |[x, y, _]| around(z).map(|z| (session, [x, y, z])));
        cells.filter_map(|cell| self.by_cell.get(&cell)).flatten().copied().collect()
    }

    /// Puts an object where its boxes are.
    pub(super) fn put(&mut self, root: AnchorSeq, object: &MergedAnchor) {
        let centres = object.shapes.iter().filter_map(|(session, shape)| Some((*session, shape.aabb?)));
        let cells: Vec<Cell> =
            centres.map(|(session, aabb)| (session, coordinates(&aabb.centre()))).collect();
        if self.cells_of.get(&root) == Some(&cells) {
            return;
        }
        self.take(root);
        for cell in &cells {
            self.by_cell.entry(*cell).or_default().insert(root);
        }
        if !cells.is_empty() {
            self.cells_of.insert(root, cells);
        }
    }

    /// Takes an object that is gone.
    pub(super) fn take(&mut self, root: AnchorSeq) {
        for cell in self.cells_of.remove(&root).unwrap_or_default() {
            if remove_last(self.by_cell.get_mut(&cell), &root) {
                self.by_cell.remove(&cell);
            }
        }
    }
}

fn coordinates(place: &Point3) -> [i64; 3] {
    // A place beyond the largest whole number is in the last cell.
    [place.x, place.y, place.z].map(|at| (at / CELL_M).floor() as i64)
}
