//! A field of a shape: how it is declared, and how it is read.

use proc_macro2::{Literal, TokenStream as Tokens, TokenTree};
use quote::{ToTokens as _, quote};
use syn::{Attribute, GenericArgument, Ident, Meta, PathArguments, Type};

/// The source that a shape is read from.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Source {
    /// A body: JSON.
    Body,
    /// A query: texts.
    Query,
}

/// A field, without the attributes that only this crate knows.
pub struct Field {
    declaration: syn::Field,
    is_id: bool,
    is_null: bool,
    reader: Option<Tokens>,
    source: Option<Tokens>,
    is_rounded: bool,
    bounds: Bounds,
}

/// The bounds of `#[schema(...)]` and `#[param(...)]`.
#[derive(Default)]
struct Bounds {
    minimum: Option<String>,
    maximum: Option<String>,
    min_length: Option<String>,
    max_length: Option<String>,
    min_items: Option<String>,
    max_items: Option<String>,
    default: Option<Tokens>,
}

impl Bounds {
    /// Takes `key = value` pieces; what is no bound is passed over.
    fn take(&mut self, tokens: Tokens) {
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
fn number<T: std::str::FromStr>(text: &str) -> Option<T> {
    let digits: String = text.chars().filter(|digit| *digit != '_').collect();
    let suffix = ["i64", "u64", "f64", "usize"].into_iter().find_map(|suffix| digits.strip_suffix(suffix));
    suffix.unwrap_or(&digits).parse().ok()
}

fn whole(bound: Option<&String>, otherwise: i64) -> Literal {
    Literal::i64_suffixed(bound.and_then(|text| number(text)).unwrap_or(otherwise))
}

fn float(bound: Option<&String>, otherwise: f64) -> Literal {
    Literal::f64_suffixed(bound.and_then(|text| number(text)).unwrap_or(otherwise))
}

fn count(bound: Option<&String>) -> Literal {
    Literal::usize_suffixed(bound.and_then(|text| number(text)).unwrap_or(0))
}

/// Returns the type within `Option<...>` or `Vec<...>`.
fn within<'t>(of: &'t Type, outer: &str) -> Option<&'t Type> {
    let Type::Path(path) = of else { return None };
    let last = path.path.segments.last().filter(|last| last.ident == outer)?;
    let PathArguments::AngleBracketed(arguments) = &last.arguments else { return None };
    arguments.args.iter().find_map(|argument| match argument {
        GenericArgument::Type(inner) => Some(inner),
        _ => None,
    })
}

/// Returns the name of a type without arguments.
fn plain(of: &Type) -> Option<String> {
    let Type::Path(path) = of else { return None };
    let last = path.path.segments.last()?;
    last.arguments.is_none().then(|| last.ident.to_string())
}

impl Field {
    pub fn of(field: &syn::Field) -> syn::Result<Self> {
        let mut this = Self {
            declaration: syn::Field { attrs: Vec::new(), ..field.clone() },
            is_id: false,
            is_null: false,
            reader: None,
            source: None,
            is_rounded: false,
            bounds: Bounds::default(),
        };
        for attribute in &field.attrs {
            this.take(attribute)?;
        }
        Ok(this)
    }

    fn take(&mut self, attribute: &Attribute) -> syn::Result<()> {
        let path = attribute.path();
        if path.is_ident("id") {
            self.is_id = true;
        } else if path.is_ident("null") {
            self.is_null = true;
        } else if path.is_ident("rounded") {
            self.is_rounded = true;
        } else if path.is_ident("from") {
            self.source = Some(attribute.meta.require_list()?.tokens.clone());
        } else if path.is_ident("read") {
            self.reader = Some(attribute.meta.require_list()?.tokens.clone());
        } else {
            if let Meta::List(list) = &attribute.meta
                && (path.is_ident("schema") || path.is_ident("param"))
            {
                self.bounds.take(list.tokens.clone());
            }
            self.declaration.attrs.push(attribute.clone());
        }
        Ok(())
    }

    pub fn ident(&self) -> &Ident {
        self.declaration.ident.as_ref().unwrap_or_else(|| unreachable!("the fields are named"))
    }

    /// Its name in JSON.
    pub fn name(&self) -> String {
        let name = self.ident().to_string();
        name.strip_prefix("r#").map_or(name.clone(), str::to_owned)
    }

    /// Its declaration, for serde and utoipa.
    pub fn declared(&self, source: Source) -> Tokens {
        let declaration = &self.declaration;
        let is_optional = within(&declaration.ty, "Option").is_some();
        let left_out = (source == Source::Body && is_optional && !self.is_null)
            .then(|| quote!(#[serde(default, skip_serializing_if = "Option::is_none")]));
        let id = self.is_id.then(|| self.declared_id(source));
        let has_default = source == Source::Query && self.bounds.default.is_some();
        let not_required = has_default.then(|| quote!(#[param(required = false)]));
        quote!(#left_out #id #not_required #declaration)
    }

    /// The rule for ids, in the API document.
    fn declared_id(&self, source: Source) -> Tokens {
        let optional = within(&self.declaration.ty, "Option");
        let is_list = within(optional.unwrap_or(&self.declaration.ty), "Vec").is_some();
        let shown = if is_list { quote!(Vec<crate::api::names::Id>) } else { quote!(String) };
        let shown = if optional.is_some() { quote!(Option<#shown>) } else { shown };
        let rule = if is_list {
            quote!(value_type = #shown, inline)
        } else {
            quote! {
                value_type = #shown, min_length = 1, max_length = 128,
                pattern = r"^(\.{0,2}[A-Za-z0-9_:-]|\.{3})[A-Za-z0-9._:-]*$"
            }
        };
        match source {
            Source::Body => quote!(#[schema(#rule)]),
            Source::Query => quote!(#[param(#rule)]),
        }
    }

    /// Returns the expression of its value, of a model that is called `of`.
    pub fn shown(&self, is_borrowed: bool) -> Tokens {
        let ident = self.ident();
        let value = match &self.source {
            Some(source) => source.clone(),
            None if is_borrowed => quote!(of.#ident.clone()),
            None => quote!(of.#ident),
        };
        if !self.is_rounded {
            return quote!(crate::api::shown::Shown::shown(#value));
        }
        let rounded = quote!(crate::api::space::rounded);
        if matches!(&self.declaration.ty, Type::Path(path) if path.path.is_ident("f64")) {
            quote!(#rounded(#value))
        } else {
            quote!((#value).map(#rounded))
        }
    }

    /// Returns the expression that reads it from an object.
    pub fn reader(&self, source: Source) -> syn::Result<Tokens> {
        let name = self.name();
        let optional = within(&self.declaration.ty, "Option");
        let read = self.read(optional.unwrap_or(&self.declaration.ty), source)?;
        if optional.is_some() {
            return Ok(quote!(object.optional(#name, |node| #read)));
        }
        let Some(default) = &self.bounds.default else {
            return Ok(quote!(object.required(#name, |node| #read)));
        };
        Ok(quote!(object.optional(#name, |node| #read).map(|found| found.unwrap_or(#default))))
    }

    /// Returns the expression that reads a value of this type from `node`.
    fn read(&self, of: &Type, source: Source) -> syn::Result<Tokens> {
        if let Some(reader) = &self.reader {
            return Ok(quote!((#reader)(node)));
        }
        if let Some(item) = within(of, "Vec") {
            let (item, most) = (self.read(item, source)?, count(self.bounds.max_items.as_ref()));
            let Some(least) = &self.bounds.min_items else {
                return Ok(quote!(node.list(#most, |node| #item)));
            };
            let least = count(Some(least));
            return Ok(quote!(node.some_of(#least..=#most, |node| #item)));
        }
        if self.is_id {
            return Ok(quote!(crate::api::decoding::read::id::<#of>(node)));
        }
        let Bounds { minimum, maximum, min_length, max_length, .. } = &self.bounds;
        if let Type::Array(array) = of {
            let (least, most, len) =
                (float(minimum.as_ref(), f64::MIN), float(maximum.as_ref(), f64::MAX), &array.len);
            return Ok(quote!(node.numbers::<{ #len }>(#least..=#most)));
        }
        let name = plain(of).unwrap_or_default();
        Ok(match name.as_str() {
            "bool" if source == Source::Query => quote!(crate::api::decoding::read::written_switch(node)),
            "bool" => quote!(crate::api::decoding::read::switch(node)),
            "f64" => {
                let (least, most) = (float(minimum.as_ref(), f64::MIN), float(maximum.as_ref(), f64::MAX));
                quote!(node.number(#least..=#most))
            }
            "u8" | "u16" | "u32" | "u64" | "usize" | "i64" => {
                let otherwise = match name.as_str() {
                    "u8" => (0, u8::MAX.into()),
                    "u16" => (0, u16::MAX.into()),
                    "u32" => (0, u32::MAX.into()),
                    "i64" => (i64::MIN, i64::MAX),
                    _ => (0, i64::MAX),
                };
                let (least, most) =
                    (whole(minimum.as_ref(), otherwise.0), whole(maximum.as_ref(), otherwise.1));
                let reader = if source == Source::Query { quote!(digits) } else { quote!(whole) };
                quote!(node.#reader(#least..=#most).and_then(|number| #of::try_from(number).ok()))
            }
            "String" => {
                let Some(most) = max_length else {
                    return Err(syn::Error::new_spanned(of.to_token_stream(), "a text needs max_length"));
                };
                let most = count(Some(most));
                if min_length.is_some() { quote!(node.name(#most)) } else { quote!(node.text(#most)) }
            }
            _ => quote!(<#of as crate::api::decoding::read::Decode>::decode(node)),
        })
    }
}
