//! Identifiers: text ids chosen by clients, and dense numbers given by a map.
//!
//! Inside a map everything is named by a small dense number (rust-analyzer's
//! `FileId` idea): graphs are maps of numbers, not pointers. The numbers are
//! facts, kept in the store, and are never given twice.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};
use thiserror::Error;

/// The longest id a client may choose, in bytes.
pub const MAX_ID_BYTES: usize = 128;

/// The reason why a text is not an id.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
pub enum IdError {
    /// The id has no character at all.
    #[error("an id must not be empty")]
    Empty,
    /// The id is longer than [`MAX_ID_BYTES`].
    #[error("an id has at most {MAX_ID_BYTES} characters, this one has {0}")]
    TooLong(usize),
    /// The id has a character outside `[A-Za-z0-9._:-]`.
    #[error("an id is made of A-Z a-z 0-9 . _ : -, not of {0:?}")]
    Character(char),
    /// The id is `.` or `..`, which clients and proxies resolve away in a path.
    #[error("`.` and `..` are steps of a path, not ids")]
    Dots,
}

/// The form of an id, as refusals show it.
pub const ID_FORM: &str = "[A-Za-z0-9._:-]{1,128}, but neither . nor ..";

fn check(text: &str) -> Result<(), IdError> {
    match text {
        "" => return Err(IdError::Empty),
        "." | ".." => return Err(IdError::Dots),
        _ => {}
    }
    if let Some(wrong) =
        text.chars().find(|c| !(c.is_ascii_alphanumeric() || matches!(c, '.' | '_' | ':' | '-')))
    {
        return Err(IdError::Character(wrong));
    }
    if text.len() > MAX_ID_BYTES {
        return Err(IdError::TooLong(text.len()));
    }
    Ok(())
}

/// An id as the store gives it back.
pub trait StoredId: Sized {
    /// Reads an id that was accepted once; that of a map may name a release.
    fn stored(text: &str) -> Result<Self, IdError>;
}

macro_rules! text_id {
    ($(#[$doc:meta])* $name:ident) => {
        text_id!($(#[$doc])* $name, check);
    };
    ($(#[$doc:meta])* $name:ident, $check_stored:ident) => {
        $(#[$doc])*
        #[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
        #[serde(into = "Box<str>", try_from = "Box<str>")]
        pub struct $name(Box<str>);

        impl $name {
            /// Returns the id as the client wrote it.
            pub fn as_str(&self) -> &str {
                &self.0
            }
        }

        impl FromStr for $name {
            type Err = IdError;

            fn from_str(text: &str) -> Result<Self, IdError> {
                check(text)?;
                Ok(Self(text.into()))
            }
        }

        impl StoredId for $name {
            fn stored(text: &str) -> Result<Self, IdError> {
                $check_stored(text)?;
                Ok(Self(text.into()))
            }
        }

        impl fmt::Display for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(&self.0)
            }
        }

        impl TryFrom<Box<str>> for $name {
            type Error = IdError;

            fn try_from(text: Box<str>) -> Result<Self, IdError> {
                Self::stored(&text)
            }
        }

        impl From<$name> for Box<str> {
            fn from(id: $name) -> Self {
                id.0
            }
        }
    };
}

text_id!(
    /// A map, named by its client; or a release of one, named by the map, a slash and the release.
    MapId,
    check_stored_map
);
text_id!(
    /// A release of a map, named by who published it.
    ReleaseName
);

/// Between the names of a map and its release. No id that a client gives has one.
const RELEASE_MARK: char = '/';

fn check_stored_map(text: &str) -> Result<(), IdError> {
    let Some((map, release)) = text.split_once(RELEASE_MARK) else { return check(text) };
    check(map)?;
    check(release)
}

impl MapId {
    /// Returns the id of the map that holds a release of this one.
    pub fn of_release(&self, name: &ReleaseName) -> Self {
        Self(format!("{self}{RELEASE_MARK}{name}").into())
    }

    /// Returns the id as its clients know it, and the release's name if it holds one.
    pub fn parts(&self) -> (&str, Option<&str>) {
        let parts = self.0.split_once(RELEASE_MARK);
        parts.map_or((&*self.0, None), |(map, release)| (map, Some(release)))
    }
}
text_id!(
    /// A keyframe, named by the robot that made it.
    KeyframeId
);
text_id!(
    /// One robot's run: its own frame and its own numbering of map points.
    SessionId
);

impl Default for SessionId {
    /// Returns `default`, the session of a client that names none.
    fn default() -> Self {
        Self("default".into())
    }
}
text_id!(
    /// A loop that a client closed.
    LoopId
);
text_id!(
    /// A prior anchor, named by the client that knows it from a plan.
    PriorId
);
text_id!(
    /// A job that asks a map's verdicts again.
    JudgementId
);
text_id!(
    /// A backup, named by whoever asked for it.
    BackupId
);

text_id!(
    /// A model that computes global descriptors, named by its client.
    GlobalModelId
);

macro_rules! dense_id {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
        pub struct $name(pub u32);

        impl $name {
            /// Returns the number as an index.
            pub fn index(self) -> usize {
                self.0 as usize
            }
        }
    };
}

dense_id!(
    /// A keyframe's dense number in its map, in order of arrival.
    KeyframeSeq
);
dense_id!(
    /// An anchor's dense number in its map, in order of creation: the smaller is the older.
    AnchorSeq
);
dense_id!(
    /// A session's dense number in its map, in order of first appearance.
    SessionSeq
);

/// A map point's number, as its session counts them.
pub type PointId = i64;

/// The anchor's public id, `a-7`.
impl fmt::Display for AnchorSeq {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "a-{}", self.0)
    }
}

impl AnchorSeq {
    /// Returns the anchor's public id.
    pub fn public(self) -> String {
        self.to_string()
    }

    /// Returns the anchor that a public id names, if it has that form.
    pub fn from_public(text: &str) -> Option<Self> {
        let seq = Self(text.strip_prefix("a-")?.parse().ok()?);
        // `a-07` and `a-+7` would be second names of `a-7`.
        (seq.public() == text).then_some(seq)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_id_has_1_to_128_of_the_allowed_characters() {
        assert!("kf-1.a_b:C".parse::<KeyframeId>().is_ok());
        assert!("x".repeat(128).parse::<KeyframeId>().is_ok());
        assert_eq!("x".repeat(129).parse::<KeyframeId>(), Err(IdError::TooLong(129)));
        assert_eq!("".parse::<MapId>(), Err(IdError::Empty));
        assert_eq!("a/b".parse::<MapId>(), Err(IdError::Character('/')));
        assert_eq!("é".parse::<MapId>(), Err(IdError::Character('é')));
    }

    #[test]
    fn a_step_of_a_path_is_no_id() {
        for dots in [".", ".."] {
            assert_eq!(dots.parse::<SessionId>(), Err(IdError::Dots));
            assert_eq!(SessionId::stored(dots), Err(IdError::Dots));
        }
        for id in ["...", ".a", "a.", "..-"] {
            assert!(id.parse::<SessionId>().is_ok(), "{id}");
        }
        assert_eq!(SessionId::stored("a/b"), Err(IdError::Character('/')));
    }

    #[test]
    fn a_release_is_stored_under_an_id_that_no_client_can_give() {
        let tower: MapId = "tower".parse().unwrap();
        let id = tower.of_release(&"2026-11".parse().unwrap());
        assert_eq!((id.parts(), tower.parts()), (("tower", Some("2026-11")), ("tower", None)));
        assert_eq!(MapId::stored(id.as_str()), Ok(id.clone()));
        assert!(id.as_str().parse::<MapId>().is_err());
        assert!(MapId::stored("a/b/c").is_err() && MapId::stored("a/").is_err());
    }

    #[test]
    fn an_anchor_has_one_public_name() {
        assert_eq!(AnchorSeq::from_public(&AnchorSeq(7).public()), Some(AnchorSeq(7)));
        for wrong in ["a-07", "a-+7", "b-7", "a-", "7", "a-4294967296"] {
            assert_eq!(AnchorSeq::from_public(wrong), None, "{wrong}");
        }
    }
}
