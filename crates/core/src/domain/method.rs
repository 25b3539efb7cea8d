//! Methods: settings that belong together, under one name.

pub use super::settings::Method;
use super::settings::{SettingValue, Settings};

impl Method {
    /// Returns the settings that tell the methods apart, with their values in this one.
    pub fn settings(self) -> impl Iterator<Item = (&'static str, SettingValue)> {
        let defaults = Settings::default();
        Settings::TABLE.iter().filter_map(move |row| {
            let paper = row.paper.clone()?;
            let value = match self {
                Self::Paper => paper,
                Self::Revisit => defaults.get(row.name).unwrap_or(paper),
            };
            Some((row.name, value))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::domain::settings::SettingSource;

    #[test]
    fn a_method_names_settings_that_there_are_and_every_switch_is_one_of_ours() {
        let mut settings = Settings::default();
        for (name, value) in Method::Paper.settings() {
            assert_eq!(settings.set(name, value), Ok(()), "{name}");
        }
        for row in Settings::TABLE {
            let is_on = settings.get(row.name) == Some(SettingValue::Switch(true));
            assert!(!is_on || row.source == SettingSource::Storage, "{} is not the paper's", row.name);
        }
        for (name, value) in Method::Revisit.settings() {
            assert_eq!(settings.set(name, value), Ok(()), "{name}");
        }
        assert_eq!(settings, Settings::default());
    }
}
