//! A field of a shape: how it is declared, and how it is read.

use proc_macro2::TokenStream as Tokens;
use quote::{ToTokens as _, quote};
use syn::{Attribute, GenericArgument, Ident, Meta, PathArguments, Type};

use crate::bounds::Bounds;
use crate::column::Column;

/// The source that a shape is read from.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Source {
    /// A body: JSON.
    Body,
    /// A query: texts.
    Query,
}

/// Attributes that say no more than their name.
const MARKS: [&str; 5] = ["id", "null", "rounded", "unique", "unread"];

/// A field, without the attributes that only this crate knows.
pub struct Field {
    declaration: syn::Field,
    /// Those of [`MARKS`] that it has.
    marks: Vec<&'static str>,
    reader: Option<Tokens>,
    source: Option<Tokens>,
    value: Option<Tokens>,
    parallel_to: Option<Ident>,
    column: Option<Column>,
    renamed: Option<String>,
    bounds: Bounds,
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
            marks: Vec::new(),
            reader: None,
            source: None,
            value: None,
            parallel_to: None,
            column: None,
            renamed: None,
            bounds: Bounds::default(),
        };
        for attribute in &field.attrs {
            this.take(attribute)?;
        }
        Ok(this)
    }

    fn has(&self, mark: &str) -> bool {
        self.marks.contains(&mark)
    }

    fn take(&mut self, attribute: &Attribute) -> syn::Result<()> {
        let path = attribute.path();
        if let Some(mark) = MARKS.into_iter().find(|mark| path.is_ident(mark)) {
            self.marks.push(mark);
        } else if path.is_ident("parallel") {
            self.parallel_to = Some(attribute.parse_args()?);
        } else if path.is_ident("column") {
            self.column = Some(attribute.parse_args()?);
        } else if path.is_ident("from") {
            self.source = Some(attribute.meta.require_list()?.tokens.clone());
        } else if path.is_ident("is") {
            self.value = Some(attribute.meta.require_list()?.tokens.clone());
        } else if path.is_ident("read") {
            self.reader = Some(attribute.meta.require_list()?.tokens.clone());
        } else {
            if let Meta::List(list) = &attribute.meta
                && (path.is_ident("schema") || path.is_ident("param"))
            {
                self.bounds.take(list.tokens.clone());
            }
            if path.is_ident("serde")
                && let Ok(Meta::NameValue(value)) = attribute.parse_args::<Meta>()
                && value.path.is_ident("rename")
                && let syn::Expr::Lit(syn::ExprLit { lit: syn::Lit::Str(name), .. }) = value.value
            {
                self.renamed = Some(name.value());
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
        let name = || self.ident().to_string().trim_start_matches("r#").to_owned();
        self.renamed.clone().unwrap_or_else(name)
    }

    /// Its names in a JSON that a client sends: that of its list, and that of its packed form.
    pub fn names(&self) -> Vec<String> {
        let packed = self.column.as_ref().map(|column| column.packed.to_string());
        [self.name()].into_iter().chain(packed).collect()
    }

    /// Its declaration, for serde and utoipa.
    pub fn declared(&self, source: Source) -> Tokens {
        let declaration = &self.declaration;
        let is_optional = within(&declaration.ty, "Option").is_some();
        let left_out = (source == Source::Body && is_optional && !self.has("null"))
            .then(|| quote!(#[serde(default, skip_serializing_if = "Option::is_none")]));
        let id = self.has("id").then(|| self.declared_id(source));
        let has_default = source == Source::Query && self.bounds.has("default");
        let not_required = has_default.then(|| quote!(#[param(required = false)]));
        quote!(#left_out #id #not_required #declaration)
    }

    /// Its declaration in the schema of what clients send, where a column may be a list or packed.
    pub fn sent(&self) -> syn::Result<Tokens> {
        let Some(column) = &self.column else { return Ok(self.declared(Source::Body)) };
        let syn::Field { attrs, ty, .. } = &self.declaration;
        let (name, packed, about) = (self.ident(), &column.packed, column.about());
        let most = column.most_chars(self.bounds.number("max_items").unwrap_or(0))?;
        let is_optional = within(ty, "Option").is_some();
        let list = if is_optional { quote!(#ty) } else { quote!(Option<#ty>) };
        let required = format!(" This or `{packed}` is required.");
        let required = (!is_optional).then(|| quote!(#[doc = #required] #[schema(required = false)]));
        Ok(quote! {
            #(#attrs)*
            #required
            pub #name: #list,
            #[doc = #about]
            #[schema(max_length = #most)]
            pub #packed: Option<String>
        })
    }

    /// The rule for ids, in the API document.
    fn declared_id(&self, source: Source) -> Tokens {
        let optional = within(&self.declaration.ty, "Option");
        let is_list = within(optional.unwrap_or(&self.declaration.ty), "Vec").is_some();
        let shown = if is_list { quote!(Vec<::revisit_api::names::Id>) } else { quote!(String) };
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
        if let Some(value) = &self.value {
            return value.clone();
        }
        let ident = self.ident();
        let value = self.source.clone().unwrap_or_else(|| quote!(of.#ident));
        if !self.has("rounded") {
            let borrowed = (is_borrowed && self.source.is_none()).then(|| quote!(&));
            return quote!(::revisit_api::shown::Shown::shown(#borrowed #value));
        }
        let rounded = quote!(::revisit_api::space::rounded);
        if matches!(&self.declaration.ty, Type::Path(path) if path.path.is_ident("f64")) {
            quote!(#rounded(#value))
        } else {
            quote!((#value).map(#rounded))
        }
    }

    /// Returns the expression that reads it from an object.
    pub fn reader(&self, source: Source) -> syn::Result<Tokens> {
        if self.has("unread") {
            return Ok(quote!(Some(None)));
        }
        let name = self.name();
        let optional = within(&self.declaration.ty, "Option");
        let read = self.read(optional.unwrap_or(&self.declaration.ty), source)?;
        if self.column.is_some() {
            let column = self.as_column();
            let method = if optional.is_some() { quote!(optional_column) } else { quote!(required_column) };
            return Ok(quote!(object.#method(#column, |node| #read)));
        }
        if optional.is_some() {
            return Ok(quote!(object.optional(#name, |node| #read)));
        }
        let Some(default) = self.bounds.default_value() else {
            return Ok(quote!(object.required(#name, |node| #read)));
        };
        Ok(quote!(object.optional(#name, |node| #read).map(|found| found.unwrap_or(#default))))
    }

    /// Returns the expression that is this field as a column of the decoder.
    pub fn as_column(&self) -> Tokens {
        let name = self.name();
        let packed = self.column.as_ref().map(|Column { packed, number, row }| {
            let packed = packed.to_string();
            let row = if let Some(row) = row { quote!(Some(#row)) } else { quote!(None) };
            quote! {
                ::revisit_api::decoding::column::Packed {
                    name: #packed, number: ::revisit_api::decoding::column::Number::#number, row: #row
                }
            }
        });
        let packed = if let Some(packed) = packed { quote!(Some(#packed)) } else { quote!(None) };
        quote!(::revisit_api::decoding::column::Column { list: #name, packed: #packed })
    }

    /// Returns the name of the list that this one must be as long as.
    pub fn parallel_to(&self) -> Option<&Ident> {
        self.parallel_to.as_ref()
    }

    /// Returns the expression that reads a value of this type from `node`.
    fn read(&self, of: &Type, source: Source) -> syn::Result<Tokens> {
        if let Some(reader) = &self.reader {
            return Ok(quote!((#reader)(node)));
        }
        let bounds = &self.bounds;
        if let Some(item) = within(of, "Vec") {
            let (item, most) = (self.read(item, source)?, bounds.count("max_items"));
            if self.has("unique") {
                return Ok(quote!(node.unique(#most, |node| #item)));
            }
            if !bounds.has("min_items") {
                return Ok(quote!(node.list(#most, |node| #item)));
            }
            let least = bounds.count("min_items");
            return Ok(quote!(node.some_of(#least..=#most, |node| #item)));
        }
        if self.has("id") {
            return Ok(quote!(::revisit_api::decoding::read::id::<#of>(node)));
        }
        let floats = || (bounds.float("minimum", f64::MIN), bounds.float("maximum", f64::MAX));
        if let Type::Array(array) = of {
            let ((least, most), len) = (floats(), &array.len);
            return Ok(quote!(node.numbers::<{ #len }>(#least..=#most)));
        }
        let name = plain(of).unwrap_or_default();
        Ok(match name.as_str() {
            "bool" if source == Source::Query => quote!(::revisit_api::decoding::read::written_switch(node)),
            "bool" => quote!(::revisit_api::decoding::read::switch(node)),
            "f64" => {
                let (least, most) = floats();
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
                    (bounds.whole("minimum", otherwise.0), bounds.whole("maximum", otherwise.1));
                let reader = if source == Source::Query { quote!(digits) } else { quote!(whole) };
                quote!(node.#reader(#least..=#most).and_then(|number| #of::try_from(number).ok()))
            }
            "String" => {
                if !bounds.has("max_length") {
                    return Err(syn::Error::new_spanned(of.to_token_stream(), "a text needs max_length"));
                }
                let most = bounds.count("max_length");
                if bounds.has("min_length") { quote!(node.name(#most)) } else { quote!(node.text(#most)) }
            }
            _ => quote!(<#of as ::revisit_api::decoding::read::Decode>::decode(node)),
        })
    }
}
