//! Bounds of a field, as `#[schema(...)]` and `#[param(...)]` say them.

use std::collections::HashMap;
use std::str::FromStr;

use proc_macro2::{Literal, TokenStream as Tokens, TokenTree};

/// The values of `#[schema(...)]` and `#[param(...)]`, by name.
#[derive(Default)]
pub struct Bounds(HashMap<String, Vec<TokenTree>>);

impl Bounds {
    /// Takes `key = value` pieces.
    pub fn take(&mut self, tokens: Tokens) {
        let tokens: Vec<TokenTree> = tokens.into_iter().collect();
        let is_comma = |token: &TokenTree| matches!(token, TokenTree::Punct(punct) if punct.as_char() == ',');
        for piece in tokens.split(is_comma) {
            if let [TokenTree::Ident(key), TokenTree::Punct(_), value @ ..] = piece {
                self.0.insert(key.to_string(), value.to_vec());
            }
        }
    }

    pub fn has(&self, key: &str) -> bool {
        self.0.contains_key(key)
    }

    /// Returns what a value is that is left out.
    pub fn default_value(&self) -> Option<Tokens> {
        Some(self.0.get("default")?.iter().cloned().collect())
    }

    /// Returns a literal's number, without its suffix and underscores.
    pub fn number<T: FromStr>(&self, key: &str) -> Option<T> {
        let text: String = self.0.get(key)?.iter().map(ToString::to_string).collect();
        let digits = text.replace('_', "");
        let suffix =
            ["i64", "u64", "f64", "usize"].into_iter().find_map(|suffix| digits.strip_suffix(suffix));
        suffix.unwrap_or(&digits).parse().ok()
    }

    pub fn whole(&self, key: &str, otherwise: i64) -> Literal {
        Literal::i64_suffixed(self.number(key).unwrap_or(otherwise))
    }

    pub fn float(&self, key: &str, otherwise: f64) -> Literal {
        Literal::f64_suffixed(self.number(key).unwrap_or(otherwise))
    }

    pub fn count(&self, key: &str) -> Literal {
        Literal::usize_suffixed(self.number(key).unwrap_or(0))
    }
}
