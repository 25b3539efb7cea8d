//! Words: their worth, in the languages that buildings use.

pub mod dictionary;
pub mod generic;
pub mod misreading;
pub mod role;
pub mod stable_hash;
pub mod word_list;
pub mod words;
