//! A rotation about the vertical and a translation, by weighted least squares, with its uncertainty.

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector2, Vector3};

/// A transformation with four degrees of freedom between two frames whose z points up; its scale is 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanarPose {
    /// Cosine of the rotation about z.
    pub cos: f64,
    /// Sine of the rotation about z.
    pub sin: f64,
    /// The translation, in metres.
    pub translation: Vector3<f64>,
}

impl PlanarPose {
    /// Returns a point of the inner frame in the outer one.
    pub fn transform(&self, point: &Vector3<f64>) -> Vector3<f64> {
        let turned = self.rotate(&point.xy());
        Vector3::new(turned.x, turned.y, point.z) + self.translation
    }

    /// Returns a direction along the floor in the outer frame.
    pub fn rotate(&self, direction: &Vector2<f64>) -> Vector2<f64> {
        Vector2::new(
            self.cos * direction.x - self.sin * direction.y,
            self.sin * direction.x + self.cos * direction.y,
        )
    }

    /// Returns the angle between two rotations, in rad, in `[0, pi]`.
    pub fn angle_to(&self, other: &Self) -> f64 {
        let cos = self.cos * other.cos + self.sin * other.sin;
        let sin = self.sin * other.cos - self.cos * other.sin;
        libm::atan2(sin, cos).abs()
    }
}

impl From<PlanarPose> for Isometry3<f64> {
    fn from(pose: PlanarPose) -> Self {
        let half_angle = 0.5 * libm::atan2(pose.sin, pose.cos);
        let (sin, cos) = libm::sincos(half_angle);
        let quaternion = nalgebra::Quaternion::new(cos, 0.0, 0.0, sin);
        Self::from_parts(Translation3::from(pose.translation), UnitQuaternion::from_quaternion(quaternion))
    }
}

/// A sign in both frames, and the variance of their difference along each axis, in m².
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FitPair {
    /// In the inner frame.
    pub inner: Vector3<f64>,
    /// In the outer frame.
    pub outer: Vector3<f64>,
    /// The variance.
    pub variance: f64,
}

/// A fitted transformation and its uncertainty, which follows from how far the signs are apart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanarFit {
    /// The transformation.
    pub pose: PlanarPose,
    /// The signs' weighted mean in the inner frame: the place that is known best.
    pub centre: Vector2<f64>,
    /// The variance of that place along each axis, in m².
    pub centre_variance: f64,
    /// The variance of the rotation, in rad².
    pub yaw_variance: f64,
}

impl PlanarFit {
    /// Fits pairs; none where there are fewer than two, or all are at one place.
    pub fn of(pairs: &[FitPair]) -> Option<Self> {
        if pairs.len() < 2 {
            return None;
        }
        let weight: f64 = pairs.iter().map(|pair| 1.0 / pair.variance).sum();
        let mean = |of: fn(&FitPair) -> Vector3<f64>| -> Vector3<f64> {
            pairs.iter().map(|pair| of(pair) / pair.variance).sum::<Vector3<f64>>() / weight
        };
        let (inner, outer) = (mean(|pair| pair.inner), mean(|pair| pair.outer));
        let (mut along, mut across, mut spread) = (0.0, 0.0, 0.0);
        for pair in pairs {
            let (from, to) = ((pair.inner - inner).xy(), (pair.outer - outer).xy());
            along += from.dot(&to) / pair.variance;
            across += from.perp(&to) / pair.variance;
            spread += from.norm_squared() / pair.variance;
        }
        let norm = (along * along + across * across).sqrt();
        if !(norm > f64::EPSILON && spread > f64::EPSILON) {
            return None;
        }
        let turned = PlanarPose { cos: along / norm, sin: across / norm, translation: Vector3::zeros() };
        let translation = outer - turned.transform(&inner);
        Some(Self {
            pose: PlanarPose { translation, ..turned },
            centre: inner.xy(),
            centre_variance: 1.0 / weight,
            yaw_variance: 1.0 / spread,
        })
    }

    /// Returns the variance of a transformed point along each axis, in m²: the mean of the two axes.
    pub fn variance_at(&self, point: &Vector2<f64>) -> f64 {
        self.centre_variance + 0.5 * (point - self.centre).norm_squared() * self.yaw_variance
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn any_place() -> impl Strategy<Value = Vector3<f64>> {
        prop::array::uniform3(-50.0..50.0f64).prop_map(Vector3::from)
    }

    proptest! {
        #[test]
        fn pairs_without_noise_give_the_transformation_that_made_them(
            yaw in -3.1..3.1f64,
            translation in any_place(),
            places in prop::collection::vec(any_place(), 2..8),
        ) {
            let (sin, cos) = libm::sincos(yaw);
            let made = PlanarPose { cos, sin, translation };
            let pair = |inner: &Vector3<f64>| FitPair { inner: *inner, outer: made.transform(inner), variance: 0.1 };
            let pairs: Vec<FitPair> = places.iter().map(pair).collect();
            prop_assume!((places[0] - places[1]).xy().norm() > 0.5);
            let fit = PlanarFit::of(&pairs).unwrap();
            prop_assert!(fit.pose.angle_to(&made) < 1e-9);
            prop_assert!((fit.pose.transform(&places[0]) - made.transform(&places[0])).norm() < 1e-8);
            let isometry = Isometry3::from(fit.pose);
            let moved = isometry.transform_vector(&places[0]) + isometry.translation.vector;
            prop_assert!((moved - made.transform(&places[0])).norm() < 1e-8);
        }
    }

    #[test]
    fn signs_that_are_near_each_other_leave_the_rotation_uncertain() {
        let pair = |x: f64| {
            let place = Vector3::new(x, 0.0, 0.0);
            FitPair { inner: place, outer: place, variance: 0.09 }
        };
        // Two of variance s² at a distance d: the angle's variance is 2 s² / d².
        for distance_m in [1.0, 3.0, 12.0] {
            let fit = PlanarFit::of(&[pair(0.0), pair(distance_m)]).unwrap();
            assert!((fit.yaw_variance - 2.0 * 0.09 / (distance_m * distance_m)).abs() < 1e-12);
            assert!((fit.centre_variance - 0.045).abs() < 1e-12);
        }
        assert_eq!(PlanarFit::of(&[pair(1.0)]), None);
        assert_eq!(PlanarFit::of(&[pair(1.0), pair(1.0)]), None);
    }
}
