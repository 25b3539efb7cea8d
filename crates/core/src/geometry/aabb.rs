//! An axis-aligned bounding box of points in one frame.

use super::point::Point3;

/// A closed axis-aligned box in some frame, in metres. It may be flat, down to a single point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    min: Point3,
    max: Point3,
}

impl Aabb {
    /// Returns the smallest box around the points; `None` without any.
    pub fn around(points: impl IntoIterator<Item = Point3>) -> Option<Self> {
        points.into_iter().fold(None, |grown: Option<Self>, point| {
            Some(grown.map_or(Self { min: point, max: point }, |aabb| Self {
                min: aabb.min.inf(&point),
                max: aabb.max.sup(&point),
            }))
        })
    }

    /// Returns the corner with the smallest coordinates.
    pub fn min(&self) -> Point3 {
        self.min
    }

    /// Returns the corner with the largest coordinates.
    pub fn max(&self) -> Point3 {
        self.max
    }

    /// Returns the centre.
    pub fn centre(&self) -> Point3 {
        nalgebra::center(&self.min, &self.max)
    }

    /// Whether the point is inside or on the border. Containment is closed (M2).
    pub fn contains(&self, point: &Point3) -> bool {
        (0..3).all(|axis| self.min[axis] <= point[axis] && point[axis] <= self.max[axis])
    }

    /// Have the two boxes a point in common, be it on their borders?
    pub fn touches(&self, other: &Self) -> bool {
        (0..3).all(|axis| self.min[axis] <= other.max[axis] && other.min[axis] <= self.max[axis])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn aabb(a: [f64; 3], b: [f64; 3]) -> Aabb {
        Aabb::around([Point3::from(a), Point3::from(b)]).expect("two points")
    }

    #[test]
    fn a_box_is_closed_and_may_be_flat() {
        let flat = aabb([0.0, 0.0, 2.0], [1.0, 1.0, 2.0]);
        assert!(flat.contains(&Point3::new(1.0, 0.0, 2.0)));
        assert!(!flat.contains(&Point3::new(1.0, 0.0, 2.000_001)));
        assert_eq!(flat.centre(), Point3::new(0.5, 0.5, 2.0));
        assert!(Aabb::around([]).is_none());
    }

    #[test]
    fn boxes_that_share_a_border_touch() {
        let left = aabb([0.0; 3], [1.0; 3]);
        assert!(left.touches(&aabb([1.0, 0.0, 0.0], [2.0, 1.0, 1.0])));
        assert!(!left.touches(&aabb([1.1, 0.0, 0.0], [2.0, 1.0, 1.0])));
        assert!(left.touches(&aabb([0.2; 3], [0.3; 3])));
    }
}
