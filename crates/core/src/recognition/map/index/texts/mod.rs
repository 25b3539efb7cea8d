//! Which descriptions match: the index that keeps the number of judged pairs small (§IV-C.2).
//!
//! Ten thousand EXIT signs are one text. The judge therefore compares *distinct* texts, each new
//! one against those of its class that share a blocking key with it (an identifier, or a word
//! that two texts of level 4 must have in common); anchors match when their texts do. However
//! many anchors a map has, a new one costs the judgements of its text, and none if the text is known.
//!
//! Where very many texts match each other ("room 901 ..."), lists of matches would grow with the square of
//! their number; a text with too many therefore keeps none, and is judged anew when asked about (`matches.rs`).

mod carried;
mod equality;
mod identities;
#[cfg(test)]
mod laws;
mod matches;
mod matching;
#[cfg(test)]
mod tests;
mod text_id;
mod text_index;
mod word_groups;

pub use self::identities::IdentityId;
pub use self::text_id::TextId;
pub use self::text_index::TextIndex;
pub use self::word_groups::{GroupId, WordGroups};
