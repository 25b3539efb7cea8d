//! Bounds of a field, as `#[schema(...)]` and `#[param(...)]` say them.

use proc_macro2::{Literal, TokenStream as Tokens, TokenTree};

/// The bounds of `#[schema(...)]` and `#[param(...)]`.
#[derive(Default)]
pub struct Bounds {
    pub minimum: Option<String>,
    pub maximum: Option<String>,
    pub min_length: Option<String>,
    pub max_length: Option<String>,
    pub min_items: Option<String>,
    pub max_items: Option<String>,
    pub default: Option<Tokens>,
}

impl Bounds {
    /// Takes `key = value` pieces; what is no bound is passed over.
    pub fn take(&mut self, tokens: Tokens) {
        let tokens: Vec<TokenTree> = tokens.into_iter().collect();
        let is_comma = |token: &TokenTree| matches!(token, TokenTree::Punct(punct) if punct.as_char() == ',');
        for piece in tokens.split(is_comma) {
            let [TokenTree::Ident(key), TokenTree::Punct(_), value @ ..] = piece else { continue };
            if key == "default" {
                self.default = Some(value.iter().cloned().collect());
                continue;
            }
            let bound = match key.to_string().as_str() {
                "minimum" => &mut self.minimum,
                "maximum" => &mut self.maximum,
                "min_length" => &mut self.min_length,
                "max_length" => &mut self.max_length,
                "min_items" => &mut self.min_items,
                "max_items" => &mut self.max_items,
                _ => continue,
            };
            *bound = Some(value.iter().map(ToString::to_string).collect());
        }
    }
}

/// Returns a literal's number, without its suffix and underscores.
pub fn number<T: std::str::FromStr>(text: &str) -> Option<T> {
    let digits: String = text.chars().filter(|digit| *digit != '_').collect();
    let suffix = ["i64", "u64", "f64", "usize"].into_iter().find_map(|suffix| digits.strip_suffix(suffix));
    suffix.unwrap_or(&digits).parse().ok()
}

pub fn whole(bound: Option<&String>, otherwise: i64) -> Literal {
    Literal::i64_suffixed(bound.and_then(|text| number(text)).unwrap_or(otherwise))
}

pub fn float(bound: Option<&String>, otherwise: f64) -> Literal {
    Literal::f64_suffixed(bound.and_then(|text| number(text)).unwrap_or(otherwise))
}

pub fn count(bound: Option<&String>) -> Literal {
    Literal::usize_suffixed(bound.and_then(|text| number(text)).unwrap_or(0))
}
