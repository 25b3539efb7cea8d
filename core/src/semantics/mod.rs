//! The built-in judge of text descriptions: InformationLevel, SimilarityLevel and MergeText of §IV-A.2 without a model.
//!
//! Deterministic, symmetric, and blind to case, width, spaces and kinds of dash. A [`Text`] is parsed once and compared
//! often; two texts need comparing only if they share a blocking key.
//!
//! | concept | file | function |
//! |---|---|---|
//! | canonical spelling | `normalise.rs` | `clean`, `fold`, `bare` |
//! | tokens | `token.rs` | `tokenise` |
//! | which tokens are identifiers, which are words | `reading.rs` | `read` |
//! | the role and spelling of a number, by the tokens around it | `context.rs` | `Around` |
//! | the words with a known worth | `dictionary.rs` | `listed` |
//! | words on the signs of every building | `generic.rs` | `phrase` |
//! | a word or such a word misread, and its worth | `misreading.rs` | `misread`, `class_of` |
//! | words that only frame a description | `frame.rs` | `Frame` |
//! | colour, material and number of a thing | `looks.rs` | `Looks` |
//! | room, floor, gate, ... | `role.rs` | [`Role`], `role_of` |
//! | identifier, look-alikes, ranges | `identifier.rs` | [`Identifier`] |
//! | which numbers are the building's own | `numbering.rs` | [`Numbering`] |
//! | what a reader makes of a wall | `noise.rs` | `is_noise_number`, `is_one_symbol` |
//! | measures, dates, prices, counts | `quantity.rs` | `tokens_at` |
//! | left, right, arrows | `direction.rs` | `Directions` |
//! | sets of words and their likeness | `words.rs` | `overlap`, `prefix` |
//! | a parsed description | `text.rs` | [`Text::parse`] |
//! | what decides about texts without a rare word in common | `profile.rs` | [`Profile`] |
//! | InformationLevel, and why | `information.rs`, `information_reason.rs` | [`information()`] |
//! | do two sets of identifiers agree? | `agreement.rs` | [`conflict`] |
//! | SimilarityLevel: the rules | `similarity.rs` | [`similarity()`], [`similarity_level`] |
//! | what a level rests on | `evidence.rs` | `Evidence` |
//! | the sentence that explains a level | `reason.rs` | `sentence` |
//! | MergeText | `merge.rs` | [`merge()`] |
//! | what a model may be asked, and what binds it | `judge_routing.rs` | [`route_similarity`], [`bound_similarity`] |
//! | a text as a model's vector | `embedding.rs` | [`Embedding`] |
//! | text that addresses a model | `prompt_injection.rs` | [`addresses_a_model`] |
//! | which texts to compare at all | `blocking_keys.rs` | [`Text::keys`] |

mod agreement;
mod blocking_keys;
mod context;
mod dictionary;
mod direction;
mod embedding;
mod evidence;
mod frame;
mod generic;
mod identifier;
mod information;
mod information_reason;
mod judge_routing;
mod looks;
mod merge;
mod misreading;
mod noise;
mod normalise;
mod numbering;
mod profile;
mod prompt_injection;
mod quantity;
mod reading;
mod reason;
mod role;
mod similarity;
mod stable_hash;
mod text;
mod token;
mod words;

#[cfg(test)]
mod golden;
#[cfg(test)]
mod laws;

pub use agreement::{Conflict, conflict};
pub use embedding::Embedding;
pub use evidence::Source;
pub use identifier::Identifier;
pub use information::ENOUGH_SPECIFIC_WORDS;
pub use information_reason::information;
pub use judge_routing::{
    Route, accepts_merge, bound_similarity, has_no_new_digits, information_is_open, likeness_percent,
    route_similarity, similarity_is_open,
};
pub use merge::merge;
pub use noise::{NUMBER_DIGITS_MAX, ZERO_PERCENT};
pub use normalise::clean;
pub use numbering::{LEARNED_FROM_VALUES, Numbering, PatternError, Shape};
pub use profile::Profile;
pub use prompt_injection::addresses_a_model;
pub use role::Role;
pub use similarity::{Judgement, similarity, similarity_level};
pub use text::{Identity, Text};
