//! An entry: what a part of the log holds, and its form.

use std::borrow::Cow;

use revisit_core::domain::change::Change;
use revisit_core::domain::former::FormerValues;
use revisit_core::domain::judged::{CropRead, ModelVerdict};
use serde::{Deserialize, Serialize};

use crate::StoreError;

/// The changes of one part of a version, and the values that they replaced.
///
/// Its form is MessagePack with the names of fields: a later program reads what an earlier one wrote, as long as what it added has
/// a default.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Entry<'b> {
    /// Changes, in their order.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub changes: Vec<Cow<'b, Change>>,
    /// The values that the version's changes replaced.
    #[serde(default, skip_serializing_if = "replaces_nothing")]
    pub former: Cow<'b, FormerValues>,
    /// Findings of models that stood until then.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub unsaid: Vec<Unsaid>,
}

/// A finding of a model that another one replaced.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) enum Unsaid {
    /// Of texts.
    Verdict(ModelVerdict),
    /// Of a crop, with its dialogue.
    Reading(CropRead),
}

fn replaces_nothing(former: &FormerValues) -> bool {
    former.is_empty()
}

impl Entry<'_> {
    /// Whether it holds nothing.
    pub(crate) fn is_empty(&self) -> bool {
        self.changes.is_empty() && self.former.is_empty() && self.unsaid.is_empty()
    }

    /// Returns it as bytes.
    pub(crate) fn to_bytes(&self) -> Result<Vec<u8>, StoreError> {
        to_bytes(self)
    }

    /// Returns the entry of these bytes.
    pub(crate) fn of(bytes: &[u8]) -> Result<Entry<'static>, StoreError> {
        rmp_serde::from_slice(bytes).map_err(|error| StoreError::corrupt(format!("the log: {error}")))
    }
}

/// Returns a value in the form of the log.
pub(crate) fn to_bytes(value: &impl Serialize) -> Result<Vec<u8>, StoreError> {
    rmp_serde::to_vec_named(value).map_err(|error| StoreError::Database(error.to_string()))
}

#[cfg(test)]
pub(crate) mod tests {
    use revisit_core::domain::ids::{KeyframeSeq, SessionSeq};
    use revisit_core::domain::map::MapProperties;
    use revisit_core::domain::settings::SettingValue;
    use revisit_core::geometry::{Gravity, Point3, Sim3};
    use revisit_core::semantics::Patterns;

    use super::*;

    /// The law of the form: what is written comes back as it was. Asked of all that is written in this crate's own tests.
    pub(crate) fn expect_form(changes: &[Change], former: &FormerValues) {
        let changes = changes.iter().map(Cow::Borrowed).collect();
        let entry = Entry { changes, former: Cow::Borrowed(former), unsaid: Vec::new() };
        assert_eq!(Entry::of(&entry.to_bytes().expect("bytes")).expect("an entry"), entry);
    }

    /// The figures of docs/operators.md for `keep_history`.
    #[test]
    fn a_corrected_point_takes_about_76_bytes_and_a_pose_166() {
        let at = |n: f64| Point3::new(n + 0.1, n + 0.2, n + 0.3);
        let pose = |n: f64| Sim3::new(1.0, [n + 0.1, 0.2, 0.3], [0.0, 0.0, 0.0, 1.0]).expect("a pose");
        let (point, keyframe) =
            (|n: u32| (SessionSeq(0), 1000 + i64::from(n)), |n: u32| KeyframeSeq(1000 + n));
        let bytes = |changes: Vec<Change>, former: FormerValues| {
            let changes = changes.into_iter().map(Cow::Owned).collect();
            Entry { changes, former: Cow::Owned(former), unsaid: Vec::new() }.to_bytes().expect("bytes").len()
        };
        let points = bytes(
            (0..100).map(|n| Change::PointSet(point(n).0, point(n).1, at(1.0))).collect(),
            FormerValues {
                points: (0..100).map(|n| (point(n).0, point(n).1, Some(at(0.0)))).collect(),
                ..FormerValues::default()
            },
        );
        let poses = bytes(
            (0..100).map(|n| Change::PoseSet(keyframe(n), pose(1.0))).collect(),
            FormerValues {
                poses: (0..100).map(|n| (keyframe(n), pose(0.0))).collect(),
                ..FormerValues::default()
            },
        );
        assert!((7_000..8_000).contains(&points), "{points}");
        assert!((16_000..17_500).contains(&poses), "{poses}");
    }

    #[test]
    fn settings_of_every_kind_come_back() {
        let mut properties =
            MapProperties { gravity: Gravity::new([0.0, -1.0, 0.0]), ..MapProperties::default() };
        let patterns = Patterns::new(vec![r"\d\.\d\d".to_owned()]).expect("a pattern");
        for (name, value) in [
            ("loop_min_confidence", SettingValue::Number(0.9)),
            ("candidates_max", SettingValue::Count(7)),
            ("keep_history", SettingValue::Switch(false)),
            ("method", SettingValue::Choice("paper")),
            ("identifier_patterns", SettingValue::Patterns(patterns)),
        ] {
            properties.settings.set(name, value).expect("a setting");
        }
        expect_form(&[Change::MapSet(Box::new(properties))], &FormerValues::default());
    }
}
