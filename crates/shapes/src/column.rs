//! The packed form of a list.

use proc_macro2::Literal;
use syn::parse::{Parse, ParseStream};
use syn::{Ident, LitInt, Token};

/// The packed form of a list: its name, the type of its numbers, and how many of them an item has, if it is not a number itself.
pub struct Column {
    pub packed: Ident,
    pub number: Ident,
    pub row: Option<LitInt>,
}

impl Parse for Column {
    fn parse(input: ParseStream<'_>) -> syn::Result<Self> {
        let packed = input.parse()?;
        input.parse::<Token![,]>()?;
        let number = input.parse()?;
        let row = input.parse::<Option<Token![,]>>()?.map(|_| input.parse()).transpose()?;
        Ok(Self { packed, number, row })
    }
}

impl Column {
    /// Returns the most characters of base64 for so many items.
    pub fn most_chars(&self, items: usize) -> syn::Result<Literal> {
        let bytes = if self.number.to_string().ends_with("32") { 4 } else { 8 };
        let numbers = self.row.as_ref().map_or(Ok(1), LitInt::base10_parse::<usize>)?;
        Ok(Literal::usize_suffixed((items * numbers * bytes).div_ceil(3) * 4))
    }

    /// Returns what the API document says of the packed form.
    pub fn about(&self) -> String {
        let numbers = match self.number.to_string().as_str() {
            "U32" => "32-bit unsigned numbers",
            "I64" => "64-bit signed numbers",
            "F32" => "32-bit floats",
            _ => "64-bit floats",
        };
        let each = self.row.as_ref().map_or(String::new(), |row| format!(", {row} for each item"));
        format!("The same, packed: base64 of little-endian {numbers}{each}.")
    }
}
