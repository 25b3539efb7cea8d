//! Shown: values of the model as answers show them. `#[answer(of = ...)]` asks it of each field.

use std::fmt::Display;

use revisit_core::domain::ids::{GlobalModelId, KeyframeId, LoopId, SessionId};
use revisit_core::geometry::{Gravity, Point3};
use revisit_core::named::Named;

use super::names::Name;

/// A type of answers that shows a type of the model.
pub trait Shown<T> {
    /// Returns what is shown.
    fn shown(of: T) -> Self;
}

/// Types that are shown as they are.
macro_rules! as_they_are {
    ($($type:ty),+) => {
        $(impl Shown<Self> for $type {
            fn shown(of: Self) -> Self {
                of
            }
        }

        impl Shown<&Self> for $type {
            fn shown(of: &Self) -> Self {
                of.clone()
            }
        })+
    };
}

as_they_are!(bool, u8, u16, u32, u64, usize, i64, f64, Gravity, GlobalModelId, KeyframeId, LoopId, SessionId);

/// Ids, and texts of every kind.
impl<T: Display> Shown<T> for String {
    fn shown(of: T) -> Self {
        of.to_string()
    }
}

impl<T, S: Shown<T>> Shown<Option<T>> for Option<S> {
    fn shown(of: Option<T>) -> Self {
        of.map(S::shown)
    }
}

impl<'t, T, S: Shown<&'t T>> Shown<&'t Option<T>> for Option<S> {
    fn shown(of: &'t Option<T>) -> Self {
        of.as_ref().map(S::shown)
    }
}

impl<T, S: Shown<T>> Shown<Vec<T>> for Vec<S> {
    fn shown(of: Vec<T>) -> Self {
        of.into_iter().map(S::shown).collect()
    }
}

impl<T: Copy, S: Shown<T>, const N: usize> Shown<[T; N]> for [S; N] {
    fn shown(of: [T; N]) -> Self {
        of.map(S::shown)
    }
}

impl Shown<Point3> for [f64; 3] {
    fn shown(of: Point3) -> Self {
        of.coords.into()
    }
}

impl<T: Named> Shown<T> for Name<T> {
    fn shown(of: T) -> Self {
        Self(of)
    }
}

impl<T: Named> Shown<&T> for Name<T> {
    fn shown(of: &T) -> Self {
        Self(*of)
    }
}
