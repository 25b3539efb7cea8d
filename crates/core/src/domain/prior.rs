//! Prior anchors: signs known before any robot saw them, from a floor plan or by hand.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use super::ids::{AnchorSeq, ID_FORM, IdError, PriorId, SessionId, SessionSeq};
use crate::geometry::Point3;

/// How far the norm of a normal may be from 1: rounded files stay below it.
const MAX_NORM_ERROR: f64 = 0.01;

/// A prior anchor, as its client sent it.
#[derive(Clone, Debug, PartialEq)]
pub struct NewPrior {
    /// Its name, chosen by its client.
    pub id: PriorId,
    /// The class of the sign.
    pub class: String,
    /// The text on the sign, or its description.
    pub description: String,
    /// Its position in the plan's frame, in metres.
    pub position_in_frame: Point3,
    /// The plan's frame: a session that no robot drives.
    pub frame: SessionId,
    /// The unit vector out of the wall, towards those who read the sign, in the plan's frame.
    pub normal_in_frame: Option<[f64; 3]>,
    /// Where it is known from, for people: the file of a plan.
    pub source: Option<String>,
}

impl NewPrior {
    /// Returns what it takes on disk, in bytes.
    pub fn bytes(&self) -> u64 {
        let texts = [self.id.as_str(), &self.description, self.source.as_deref().unwrap_or_default()];
        bytes(texts, self.normal_in_frame.is_some())
    }
}

/// A prior anchor, as a fact of its map; the class is its anchor's.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Prior {
    /// Its name.
    pub id: PriorId,
    /// The plan's frame.
    pub frame: SessionSeq,
    /// The text on the sign, or its description.
    pub description: Box<str>,
    /// Its position in the plan's frame, in metres.
    pub position_in_frame: Point3,
    /// The unit vector out of the wall, in the plan's frame.
    pub normal_in_frame: Option<[f64; 3]>,
    /// Where it is known from.
    pub source: Option<Box<str>>,
}

impl Prior {
    /// Returns what it takes on disk, in bytes.
    pub fn bytes(&self) -> u64 {
        let texts = [self.id.as_str(), &self.description, self.source.as_deref().unwrap_or_default()];
        bytes(texts, self.normal_in_frame.is_some())
    }
}

fn bytes(texts: [&str; 3], has_normal: bool) -> u64 {
    let numbers = size_of::<Point3>() + if has_normal { size_of::<[f64; 3]>() } else { 0 };
    (texts.iter().map(|text| text.len()).sum::<usize>() + numbers) as u64
}

/// Whether these are the parts of a unit vector, within 1 %.
pub fn is_unit(vector: &[f64; 3]) -> bool {
    let norm = vector.iter().map(|part| part * part).sum::<f64>().sqrt();
    (norm - 1.0).abs() <= MAX_NORM_ERROR
}

/// An anchor by its public id: `a-7` of the server's own, or the name that a client gave a prior one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum AnchorKey {
    /// An anchor that the server numbered.
    Numbered(AnchorSeq),
    /// A prior anchor.
    Prior(PriorId),
}

impl FromStr for AnchorKey {
    type Err = IdError;

    fn from_str(text: &str) -> Result<Self, IdError> {
        match AnchorSeq::from_public(text) {
            Some(seq) => Ok(Self::Numbered(seq)),
            None => text.parse().map(Self::Prior),
        }
    }
}

impl From<AnchorSeq> for AnchorKey {
    fn from(seq: AnchorSeq) -> Self {
        Self::Numbered(seq)
    }
}

impl fmt::Display for AnchorKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Numbered(seq) => f.write_str(&seq.public()),
            Self::Prior(id) => id.fmt(f),
        }
    }
}

/// Whether a name has the form of the server's own ids, `a-` and digits, which no prior anchor may have.
pub fn is_servers_form(id: &str) -> bool {
    id.strip_prefix("a-")
        .is_some_and(|digits| !digits.is_empty() && digits.bytes().all(|b| b.is_ascii_digit()))
}

/// The form of a prior anchor's id, as refusals show it.
pub fn id_form() -> String {
    format!("{ID_FORM}, and not a- with a number, as the server names anchors")
}
