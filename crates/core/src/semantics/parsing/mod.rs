//! Reading a text: its canonical form, its tokens, and what each of them is.

pub mod caption;
pub mod context;
pub mod direction;
pub mod naming;
pub mod noise;
pub mod normalise;
pub mod numeral;
pub mod quantity;
pub mod reading;
pub mod token;
