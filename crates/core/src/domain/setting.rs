//! A setting: its value, its kind, its source, and how a field of [`super::settings::Settings`] takes a value.

use serde::Serialize;
use thiserror::Error;

use crate::named::Named;
use crate::semantics::Patterns;

/// The value of a setting. A number that is no count is always written with a point.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum SettingValue {
    /// A real number; its unit is in the setting's name.
    Number(f64),
    /// A whole number.
    Count(u32),
    /// On or off.
    Switch(bool),
    /// One of the setting's names.
    Choice(&'static str),
    /// Regular expressions.
    Patterns(Patterns),
}

/// The values a setting takes.
#[derive(Clone, Debug, PartialEq)]
pub enum SettingKind {
    /// A real number in `[min, max]`.
    Number {
        /// The smallest value.
        min: f64,
        /// The largest value.
        max: f64,
    },
    /// A whole number in `[min, max]`.
    Count {
        /// The smallest value.
        min: u32,
        /// The largest value.
        max: u32,
    },
    /// On or off.
    Switch,
    /// One of several names.
    Choice {
        /// The names.
        names: &'static [&'static str],
    },
    /// Regular expressions, as [`Patterns::new`] takes them.
    Patterns,
}

/// The source of a setting.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SettingSource {
    /// A section of the paper.
    Paper(&'static str),
    /// ORB-SLAM, which the paper builds on.
    OrbSlam,
    /// A choice of this project.
    Ours,
    /// Storage: it decides no verdict.
    Storage,
}

impl SettingSource {
    /// Returns the source for people.
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::Paper(section) => section,
            Self::OrbSlam => "ORB-SLAM",
            Self::Ours => "ours",
            Self::Storage => "storage",
        }
    }
}

/// One row of the table of settings.
#[derive(Clone, Debug)]
pub struct Setting {
    /// The setting's name, with its unit.
    pub name: &'static str,
    /// The unit of a number; `1` for counts, shares and factors.
    pub unit: Option<&'static str>,
    /// Its values.
    pub kind: SettingKind,
    /// Its default.
    pub default: SettingValue,
    /// The value in the paper's method, where that differs from ours by more than a threshold of the paper.
    pub paper: Option<SettingValue>,
    /// Its source.
    pub source: SettingSource,
    /// Its meaning.
    pub doc: &'static str,
}

impl Setting {
    /// Returns the source and the meaning in one sentence.
    pub fn description(&self) -> String {
        format!("{}: {}", self.source.as_str(), self.doc)
    }
}

/// The reason why a setting is refused.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum SettingError {
    /// There is no setting of this name.
    #[error("there is no such setting")]
    Unknown,
    /// The value has another type.
    #[error("expected {0}")]
    Type(&'static str),
    /// The value lies outside the bounds.
    #[error("must lie in [{min}, {max}]")]
    Range {
        /// The smallest value allowed.
        min: f64,
        /// The largest value allowed.
        max: f64,
    },
    /// The value has none of the setting's names.
    #[error("expected one of {}", .0.join(", "))]
    Choice(&'static [&'static str]),
}

/// Ties one field's type to its kind of setting.
pub(super) trait Field: Sized {
    const EXPECTED: &'static str;
    fn read(&self) -> SettingValue;
    fn accept(kind: &SettingKind, value: SettingValue) -> Result<Self, SettingError>;
}

impl<T: Named> Field for T {
    const EXPECTED: &'static str = "a name";

    fn read(&self) -> SettingValue {
        SettingValue::Choice(self.name())
    }

    fn accept(_: &SettingKind, value: SettingValue) -> Result<Self, SettingError> {
        match value {
            SettingValue::Choice(name) => Self::of_name(name).ok_or(SettingError::Choice(Self::NAMES)),
            _ => Err(SettingError::Type(Self::EXPECTED)),
        }
    }
}

impl Field for f64 {
    const EXPECTED: &'static str = "a number";

    fn read(&self) -> SettingValue {
        SettingValue::Number(*self)
    }

    fn accept(kind: &SettingKind, value: SettingValue) -> Result<Self, SettingError> {
        let value = match value {
            SettingValue::Number(number) => number,
            SettingValue::Count(count) => f64::from(count),
            _ => return Err(SettingError::Type(Self::EXPECTED)),
        };
        match kind {
            SettingKind::Number { min, max, .. } if !(*min..=*max).contains(&value) => {
                Err(SettingError::Range { min: *min, max: *max })
            }
            _ => Ok(value),
        }
    }
}

impl Field for u32 {
    const EXPECTED: &'static str = "a whole number";

    fn read(&self) -> SettingValue {
        SettingValue::Count(*self)
    }

    fn accept(kind: &SettingKind, value: SettingValue) -> Result<Self, SettingError> {
        let SettingKind::Count { min, max, .. } = *kind else {
            return Err(SettingError::Type(Self::EXPECTED));
        };
        let range = SettingError::Range { min: f64::from(min), max: f64::from(max) };
        match value {
            SettingValue::Count(count) if (min..=max).contains(&count) => Ok(count),
            SettingValue::Count(_) => Err(range),
            // JSON has one kind of number: -1 is out of range, 1.5 is no whole number.
            SettingValue::Number(number) if number.fract() == 0.0 => Err(range),
            _ => Err(SettingError::Type(Self::EXPECTED)),
        }
    }
}

impl Field for bool {
    const EXPECTED: &'static str = "true or false";

    fn read(&self) -> SettingValue {
        SettingValue::Switch(*self)
    }

    fn accept(_: &SettingKind, value: SettingValue) -> Result<Self, SettingError> {
        match value {
            SettingValue::Switch(switch) => Ok(switch),
            _ => Err(SettingError::Type(Self::EXPECTED)),
        }
    }
}

impl Field for Patterns {
    const EXPECTED: &'static str = "a list of regular expressions";

    fn read(&self) -> SettingValue {
        SettingValue::Patterns(self.clone())
    }

    fn accept(_: &SettingKind, value: SettingValue) -> Result<Self, SettingError> {
        match value {
            SettingValue::Patterns(patterns) => Ok(patterns),
            _ => Err(SettingError::Type(Self::EXPECTED)),
        }
    }
}
