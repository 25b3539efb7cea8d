//! API keys: who may do what, with which maps, how often, and at whose expense.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};
use sha2::{Digest as _, Sha256};
use thiserror::Error;

use super::ids::MapId;
use super::keyframe::Stamp;
use crate::named::named;

named! {
    /// An action that a key may permit.
    Action {
        /// Read maps and what is in them.
        Read = "read",
        /// Change them.
        Write = "write",
        /// Ask: loop queries, and the three functions about texts.
        Query = "query",
        /// Keys and backups.
        Admin = "admin",
    }
}

/// A set of actions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Actions(u8);

impl Actions {
    /// Returns the set as bits, in the order of [`Action::ALL`].
    pub fn bits(self) -> u8 {
        self.0
    }

    /// Returns the set of these bits; others are nobody's.
    pub fn from_bits(bits: u8) -> Option<Self> {
        (bits < 1 << Action::ALL.len()).then_some(Self(bits))
    }

    /// Whether it is in the set.
    pub fn has(self, action: Action) -> bool {
        self.0 & (1 << action as u8) != 0
    }

    /// Returns the actions in the set.
    pub fn iter(self) -> impl Iterator<Item = Action> {
        Action::ALL.into_iter().filter(move |action| self.has(*action))
    }
}

impl FromIterator<Action> for Actions {
    fn from_iter<I: IntoIterator<Item = Action>>(actions: I) -> Self {
        Self(actions.into_iter().fold(0, |bits, action| bits | (1 << action as u8)))
    }
}

impl fmt::Display for Actions {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names: Vec<&str> = self.iter().map(Action::as_str).collect();
        f.write_str(&names.join(", "))
    }
}

/// The reason why a text is not a pattern of map ids.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
#[error("a pattern is a map's id in which * stands for any characters: [A-Za-z0-9._:*-]{{1,128}}")]
pub struct PatternError;

/// A map's id in which `*` stands for any number of characters, `hotel-*`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub struct MapPattern(Box<str>);

impl MapPattern {
    /// Returns every map.
    pub fn every() -> Self {
        Self("*".into())
    }

    /// Returns the map that the pattern names, if it has no star.
    pub fn only_map(&self) -> Option<MapId> {
        self.0.parse().ok()
    }

    /// Whether the pattern names this map.
    pub fn matches(&self, map: &MapId) -> bool {
        let Some((first, rest)) = self.0.split_once('*') else { return map.as_str() == &*self.0 };
        let Some(mut left) = map.as_str().strip_prefix(first) else { return false };
        let mut parts: Vec<&str> = rest.split('*').collect();
        let last = parts.pop().unwrap_or_default();
        for part in parts {
            // The first place is as good as any later one: what follows has the most room there.
            let Some(at) = left.find(part) else { return false };
            left = &left[at + part.len()..];
        }
        left.ends_with(last)
    }
}

impl TryFrom<String> for MapPattern {
    type Error = PatternError;

    fn try_from(text: String) -> Result<Self, PatternError> {
        text.parse()
    }
}

impl From<MapPattern> for String {
    fn from(pattern: MapPattern) -> Self {
        pattern.0.into()
    }
}

impl FromStr for MapPattern {
    type Err = PatternError;

    fn from_str(text: &str) -> Result<Self, PatternError> {
        // What is left when every star is a letter is an id.
        match text.replace('*', "x").parse::<MapId>() {
            Ok(_) => Ok(Self(text.into())),
            Err(_) => Err(PatternError),
        }
    }
}

impl fmt::Display for MapPattern {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

/// The properties that a key is made with, and keeps for its life.
#[derive(Clone, Debug, PartialEq)]
pub struct KeyProperties {
    /// For people: whose it is.
    pub name: String,
    /// Its permissions.
    pub actions: Actions,
    /// The maps that exist for it.
    pub maps: Vec<MapPattern>,
    /// From when on it is no longer good.
    pub expires: Option<Stamp>,
    /// Requests a second.
    pub rate_per_s: Option<u32>,
    /// Maximum maps that it made and that exist.
    pub max_maps: Option<u32>,
    /// Maximum bytes of these maps with their releases.
    pub max_bytes: Option<u64>,
    /// Model calls a day (UTC) at its expense.
    pub model_daily_calls: Option<u32>,
    /// Maximum cost of these calls, in millionths of a US dollar.
    pub model_daily_microusd: Option<u64>,
}

impl KeyProperties {
    /// Whether a map of this name exists for the key.
    pub fn reaches(&self, map: &MapId) -> bool {
        self.maps.iter().any(|pattern| pattern.matches(map))
    }
}

/// A key's dense number, in order of creation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct KeySeq(pub i64);

impl KeySeq {
    /// Returns the key's public id, `key-7`.
    pub fn public(self) -> String {
        format!("key-{}", self.0)
    }

    /// Returns the key that a public id names, if it has that form.
    pub fn from_public(text: &str) -> Option<Self> {
        let seq = Self(text.strip_prefix("key-")?.parse().ok()?);
        (seq.public() == text).then_some(seq)
    }
}

/// A key, without its secret.
#[derive(Clone, Debug, PartialEq)]
pub struct Key {
    /// Its number.
    pub seq: KeySeq,
    /// The properties it was made with.
    pub properties: KeyProperties,
    /// The time when it was made, in seconds since 1970.
    pub created_sec: i64,
    /// The time when it was revoked, in seconds since 1970.
    pub revoked_sec: Option<i64>,
}

impl Key {
    /// Whether it is good at this moment.
    pub fn is_good(&self, now: Stamp) -> bool {
        self.revoked_sec.is_none() && self.properties.expires.is_none_or(|expires| now < expires)
    }
}

/// A key and its secret, which is shown this once.
pub struct MadeKey {
    /// The key.
    pub key: Key,
    /// The secret that its holder sends.
    pub secret: String,
    /// Whether the database had no key before: from now on every request needs one.
    pub is_first: bool,
}

/// The stored form of a secret.
pub type SecretHash = [u8; 32];

/// Returns the hash under which a secret is found. Secrets have 256 random bits, so one pass of SHA-256 is enough.
pub fn secret_hash(secret: &str) -> SecretHash {
    Sha256::digest(secret).into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pattern_names_the_maps_that_its_stars_can_stand_for() {
        for (pattern, named, others) in [
            ("*", &["a", "hotel-1"][..], &[][..]),
            ("hotel", &["hotel"], &["hotel-1", "hote", "Hotel"]),
            ("hotel-*", &["hotel-", "hotel-1", "hotel-1-2"], &["hotel", "my-hotel-1"]),
            ("*-1", &["hotel-1", "-1", "a-1-1"], &["hotel-2", "1"]),
            ("a*b*a", &["aba", "axbxa", "abba"], &["aa", "ab", "ba", "aab"]),
            ("a*a", &["aa", "aba"], &["a"]),
            ("a**b", &["ab", "axb"], &["a"]),
        ] {
            let pattern: MapPattern = pattern.parse().expect("a pattern");
            for map in named {
                assert!(pattern.matches(&map.parse().expect("an id")), "{pattern} is to name {map}");
            }
            for map in others {
                assert!(!pattern.matches(&map.parse().expect("an id")), "{pattern} is not to name {map}");
            }
        }
        for wrong in ["", "a/b", "a b", "é*", ".", "..", &"*".repeat(129)] {
            assert_eq!(wrong.parse::<MapPattern>(), Err(PatternError), "{wrong}");
        }
    }

    #[test]
    fn a_key_has_one_public_name() {
        assert_eq!(KeySeq::from_public(&KeySeq(7).public()), Some(KeySeq(7)));
        for wrong in ["key-07", "key-+7", "k-7", "key-", "7"] {
            assert_eq!(KeySeq::from_public(wrong), None, "{wrong}");
        }
    }
}
