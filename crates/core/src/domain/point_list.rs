//! A list of map points in few bytes.

use std::fmt;

use serde::{Deserialize, Serialize};

use super::ids::PointId;
use super::varint;

/// A list of map points in the order given. Each is kept as its difference from the one before, so that points
/// numbered one after the other take a byte each instead of eight.
#[derive(Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(into = "Vec<PointId>", from = "Vec<PointId>")]
pub struct PointList {
    bytes: Box<[u8]>,
    len: u32,
}

impl PointList {
    /// Returns the points, in their order.
    pub fn iter(&self) -> impl Iterator<Item = PointId> + '_ {
        let (mut rest, mut last) = (&*self.bytes, 0);
        std::iter::from_fn(move || {
            let difference = varint::unzigzag(varint::read(&mut rest)?);
            // Wrapping: the ends of the range are more than an i64 apart.
            last = PointId::wrapping_add(last, difference);
            Some(last)
        })
    }

    /// Returns the number of points.
    pub fn len(&self) -> usize {
        self.len as usize
    }

    /// Whether there is no point.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Whether no point is smaller than the one before.
    pub fn is_sorted(&self) -> bool {
        self.iter().is_sorted()
    }

    /// Returns the points as a plain list.
    pub fn to_vec(&self) -> Vec<PointId> {
        self.iter().collect()
    }

    /// Bytes on the heap.
    pub fn heap_bytes(&self) -> usize {
        self.bytes.len()
    }
}

impl FromIterator<PointId> for PointList {
    fn from_iter<I: IntoIterator<Item = PointId>>(points: I) -> Self {
        let (mut bytes, mut last, mut len) = (Vec::new(), 0, 0);
        for point in points {
            varint::write(varint::zigzag(point.wrapping_sub(last)), &mut bytes);
            last = point;
            len += 1;
        }
        Self { bytes: bytes.into(), len }
    }
}

impl From<&[PointId]> for PointList {
    fn from(points: &[PointId]) -> Self {
        points.iter().copied().collect()
    }
}

impl From<Vec<PointId>> for PointList {
    fn from(points: Vec<PointId>) -> Self {
        points.into_iter().collect()
    }
}

impl From<PointList> for Vec<PointId> {
    fn from(points: PointList) -> Self {
        points.to_vec()
    }
}

impl fmt::Debug for PointList {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_list().entries(self.iter()).finish()
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn any_points_come_back_in_their_order(
            points in prop::collection::vec(prop_oneof![any::<PointId>(), 0..1000_i64, Just(i64::MIN), Just(i64::MAX)], 0..40),
        ) {
            let list = PointList::from(&*points);
            prop_assert_eq!(list.len(), points.len());
            prop_assert_eq!(list.is_sorted(), points.is_sorted());
            prop_assert_eq!(list.to_vec(), points);
        }
    }

    #[test]
    fn points_numbered_one_after_the_other_take_a_byte_each() {
        let list: PointList = (5_000_000_000..5_000_000_700).collect();
        assert!(list.heap_bytes() < 710, "{}", list.heap_bytes());
    }
}
