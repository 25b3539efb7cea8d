//! Named values: an enum with its names for programs and its meanings for people, each declared once.

/// An enum whose values have names in the API document.
pub trait Named: Copy + PartialEq + 'static {
    /// The meaning of the type, for people.
    const ABOUT: &'static str;
    /// The values.
    const VALUES: &'static [Self];
    /// Their names, in the same order.
    const NAMES: &'static [&'static str];
    /// Their meanings, in the same order.
    const MEANINGS: &'static [&'static str];

    /// Returns the value's name.
    fn name(self) -> &'static str;

    /// Returns the value of a name.
    fn of_name(name: &str) -> Option<Self> {
        let at = Self::NAMES.iter().position(|known| *known == name)?;
        Self::VALUES.get(at).copied()
    }

    /// Returns the value's meaning.
    fn meaning(self) -> &'static str {
        let at = Self::VALUES.iter().position(|value| *value == self);
        at.and_then(|at| Self::MEANINGS.get(at)).copied().unwrap_or_default()
    }
}

/// Makes an enum with names; the doc comments are the meanings that the API document gives.
///
/// `Type: Words` adds a row of words for people to each value.
#[macro_export]
macro_rules! named {
    ($(#[doc = $about:literal])+ $type:ident $(default $default:ident)? {
        $($(#[doc = $meaning:literal])+ $value:ident = $name:literal,)+
    }) => {
        $(#[doc = $about])+
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum $type {
            $($(#[doc = $meaning])+ $value,)+
        }

        impl $type {
            /// The values, in the order of their names.
            pub const ALL: [Self; Self::NAMES.len()] = [$(Self::$value,)+];
            /// The values' names.
            pub const NAMES: &'static [&'static str] = &[$($name,)+];

            /// Returns the value's name in the API document.
            pub const fn as_str(self) -> &'static str {
                Self::NAMES[self as usize]
            }

            /// Returns the value of a name.
            pub fn from_name(name: &str) -> Option<Self> {
                <Self as $crate::named::Named>::of_name(name)
            }
        }

        impl serde::Serialize for $type {
            fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                serializer.serialize_str(self.as_str())
            }
        }

        impl<'de> serde::Deserialize<'de> for $type {
            fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                let name: Box<str> = serde::Deserialize::deserialize(deserializer)?;
                Self::from_name(&name).ok_or_else(|| serde::de::Error::unknown_variant(&name, Self::NAMES))
            }
        }

        impl $crate::named::Named for $type {
            const ABOUT: &'static str = concat!($($about),+).trim_ascii();
            const VALUES: &'static [Self] = &Self::ALL;
            const NAMES: &'static [&'static str] = Self::NAMES;
            const MEANINGS: &'static [&'static str] = &[$(concat!($($meaning),+).trim_ascii(),)+];

            fn name(self) -> &'static str {
                self.as_str()
            }
        }

        $(impl Default for $type {
            fn default() -> Self {
                Self::$default
            }
        })?
    };
    ($(#[doc = $about:literal])+ $type:ident: $words:ty {
        $($(#[doc = $meaning:literal])+ $value:ident = $name:literal, $row:expr;)+
    }) => {
        $crate::named::named! {
            $(#[doc = $about])+
            $type { $($(#[doc = $meaning])+ $value = $name,)+ }
        }

        impl $type {
            /// Returns the value's words for people.
            pub const fn words(self) -> &'static $words {
                const ROWS: &[$words] = &[$($row,)+];
                &ROWS[self as usize]
            }
        }
    };
}

pub use named;
