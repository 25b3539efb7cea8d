//! The form of settings: those that differ from their defaults, by name.

use std::collections::BTreeMap;

use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::settings::{SettingKind, SettingValue, Settings};
use crate::semantics::Patterns;

/// The value of a setting as it is written, whatever its kind.
#[derive(Deserialize)]
#[serde(untagged)]
enum ValueForm {
    Switch(bool),
    Count(u32),
    Number(f64),
    Patterns(Vec<String>),
    Choice(Box<str>),
}

impl ValueForm {
    /// Returns the value of a setting; `None` if it is none of its names, or no regular expression.
    fn value(self, setting: &str) -> Option<SettingValue> {
        Some(match self {
            Self::Number(number) => SettingValue::Number(number),
            Self::Count(count) => SettingValue::Count(count),
            Self::Switch(switch) => SettingValue::Switch(switch),
            Self::Choice(chosen) => {
                let row = Settings::TABLE.iter().find(|row| row.name == setting)?;
                let SettingKind::Choice { names, .. } = row.kind else { return None };
                SettingValue::Choice(names.iter().copied().find(|name| **name == *chosen)?)
            }
            Self::Patterns(texts) => SettingValue::Patterns(Patterns::new(texts).ok()?),
        })
    }
}

impl Serialize for Settings {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.changed().collect::<BTreeMap<_, _>>().serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for Settings {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let mut settings = Self::default();
        for (name, form) in BTreeMap::<Box<str>, ValueForm>::deserialize(deserializer)? {
            let value =
                form.value(&name).ok_or_else(|| D::Error::custom(format!("{name} has no such value")))?;
            settings.set(&name, value).map_err(|error| D::Error::custom(format!("{name}: {error}")))?;
        }
        Ok(settings)
    }
}
