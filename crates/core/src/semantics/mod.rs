//! The built-in judge of text descriptions: InformationLevel, SimilarityLevel and MergeText of §IV-A.2 without a model.
//!
//! Deterministic, symmetric, and blind to case, width, spaces and kinds of dash. A [`Text`] is parsed once and compared
//! often; two texts need comparing only if they share a blocking key.
//!
//! | concept | file | function |
//! |---|---|---|
//! | canonical spelling | `parsing/normalise.rs` | `clean`, `fold`, `bare` |
//! | tokens | `parsing/token.rs` | `tokenise` |
//! | which tokens are numbers, which are words | `parsing/reading.rs` | `read` |
//! | the role and spelling of a number, by the tokens around it | `parsing/context.rs` | `Around` |
//! | the words with a known worth | `lexicon/dictionary.rs` | `listed` |
//! | words on the signs of every building | `lexicon/generic.rs` | `phrase` |
//! | a word or such a word misread, and its worth | `lexicon/misreading.rs` | `misread`, `class_of` |
//! | sentences of models and people about what is to be seen | `parsing/caption.rs` | `is_caption`, `is_noun` |
//! | room, floor, gate, ... | `lexicon/role.rs` | [`Role`], `role_of` |
//! | the names in a text | `parsing/naming.rs` | `names` |
//! | a name: its parts in order, in one spelling | `names/name.rs`, `names/spelling.rs` | [`Name`] |
//! | the same, different, unsure or open | `names/relation.rs` | `compare`, [`conflict`] |
//! | codes, which are compared exactly | `names/code.rs` | `by_form` |
//! | how names are written, slot by slot | `names/shape.rs` | [`Shape`] |
//! | what an operator's patterns may cost | `names/patterns.rs` | [`Patterns`] |
//! | which numbers are the building's own | `names/numbering.rs` | [`Numbering`] |
//! | what a reader makes of a wall | `parsing/noise.rs` | `is_noise_number`, `is_one_symbol` |
//! | numerals of Chinese and Japanese | `parsing/numeral.rs` | `first_numbered` |
//! | measures, dates, prices, counts | `parsing/quantity.rs` | `tokens_at` |
//! | left, right, arrows | `parsing/direction.rs` | `Directions` |
//! | sets of words and their likeness | `lexicon/words.rs` | `overlap`, `prefix` |
//! | a parsed description | `text.rs` | [`Text`] |
//! | a description parsed, and which to compare at all | `parse.rs` | [`Text::parse`], [`Text::keys`] |
//! | what decides about texts without a rare word in common | `judge/profile.rs` | [`Profile`] |
//! | signs of every building | `judge/common_sign.rs` | [`is_common_sign`] |
//! | InformationLevel, and why | `judge/information.rs` | [`information()`] |
//! | name, notice, common sign, description, code or unknown | `judge/kind.rs` | `kind` |
//! | SimilarityLevel: the rules | `judge/similarity.rs` | [`similarity()`], [`similarity_level`] |
//! | what a level rests on, and the sentence that explains it | `judge/evidence.rs` | `Evidence` |
//! | MergeText | `judge/merge.rs` | [`merge()`] |
//! | what a model may be asked, and what binds it | `models/judge_routing.rs` | [`route_similarity`], [`bound_similarity`] |
//! | a text as a model's vector | `models/embedding.rs` | [`Embedding`] |
//! | text that addresses a model | `models/prompt_injection.rs` | [`addresses_a_model`] |

mod judge;
mod lexicon;
mod models;
mod names;
mod parse;
mod parsing;
mod text;

#[cfg(test)]
mod golden;
#[cfg(test)]
mod laws;
#[cfg(test)]
mod name_laws;
#[cfg(test)]
mod schemes;

pub use judge::common_sign::is_common_sign;
pub use judge::evidence::Source;
pub use judge::information::information;
pub use judge::merge::merge;
pub use judge::profile::Profile;
pub use judge::similarity::{Judgement, similarity, similarity_level};
pub use lexicon::role::Role;
pub use models::embedding::Embedding;
pub use models::judge_routing::{
    Route, accepts_merge, bound_similarity, has_no_new_digits, information_is_open, likeness_percent,
    route_similarity, similarity_is_open,
};
pub use models::prompt_injection::addresses_a_model;
pub use names::name::Name;
pub use names::numbering::{LEARNED_FROM_VALUES, Numbering, SHOWN_FROM_VALUES};
pub use names::patterns::{PatternError, Patterns};
pub use names::relation::{Conflict, conflict, is_conflict};
pub use names::shape::Shape;
pub use parsing::noise::{NUMBER_DIGITS_MAX, ZERO_PERCENT};
pub use parsing::normalise::{clean, fold};
pub use text::{ENOUGH_SPECIFIC_WORDS, Identity, Text, TextKind};
