//! One declaration for a JSON shape.
//!
//! A struct with one of these attributes is a schema of the API document, an encoder and, where clients send it, a decoder that tells
//! every fault with its place. The bounds are those of `#[schema(...)]` and `#[param(...)]`, which utoipa reads as well.
//!
//! | attribute | of |
//! |---|---|
//! | [`macro@answer`] | what the service sends |
//! | [`macro@body`] | what a client sends in a body |
//! | [`macro@params`] | what a client sends in a query |
//!
//! | attribute of a field | |
//! |---|---|
//! | `#[id]` | the rule for ids |
//! | `#[read(function)]` | a reader of its own; the fields before it may be used in it, each an `Option` |
//! | `#[unique]` | no item of the list is there twice |
//! | `#[column(name, number, row)]` | the list may be packed: the member for that, its numbers, and how many an item has |
//! | `#[parallel(other)]` | the list is as long as the other one |
//! | `#[unread]` | the member may be there, and is not read |
//! | `#[null]` | answered as null where it is missing |
//! | `#[from(expression)]` | its value, of the model `of` |
//! | `#[is(expression)]` | its value, as it is |
//! | `#[rounded]` | rounded, as computed numbers are |

mod bounds;
mod column;
mod field;

use field::{Field, Source};
use proc_macro::TokenStream;
use proc_macro2::TokenStream as Tokens;
use quote::quote;
use syn::parse::{Parse, ParseStream};
use syn::{Data, DeriveInput, Fields, Ident, Path, Token, Type};

/// Makes a shape that the service sends: a schema, and both ways of JSON. What is `None` is left out. `#[answer(of = Model)]`, or `of = &Model`, also
/// makes it of the model's type: a field is that of the same name as it is shown, or what `#[from(...)]` says is shown, in which the
/// model is `of`, or what `#[is(...)]` says; `#[rounded]` rounds a number that was computed.
#[proc_macro_attribute]
pub fn answer(model: TokenStream, item: TokenStream) -> TokenStream {
    let arguments = syn::parse::<Arguments>(model);
    expand(item, |shape| {
        let Arguments { decoded: None, model, sent: None } = arguments? else {
            return Err(syn::Error::new_spanned(
                &shape.input.ident,
                "an answer is made of a model, and not read",
            ));
        };
        let json = shape.json(&quote!());
        let of_model = model.map(|model| shape.made_of(&model));
        Ok(quote!(#json #of_model))
    })
}

/// Makes a shape that a client sends in a body: as [`macro@answer`], with a decoder that refuses further fields. `#[body(Model)]` also decodes the model's
/// type, by `From`; `#[body(same Model)]` as one whose fields are the same; `#[body(checked Model)]` by the method `checked` of the struct,
/// which may refuse what does not fit together. A further
/// `of = Model` makes it of the model's type, as an answer is, and `sent Name` makes the schema `Name`, in which a column may be packed.
#[proc_macro_attribute]
pub fn body(model: TokenStream, item: TokenStream) -> TokenStream {
    let arguments = syn::parse::<Arguments>(model);
    expand(item, |shape| {
        let Arguments { decoded, model, sent } = arguments?;
        let json = shape.json(&quote!(#[serde(deny_unknown_fields)]));
        let decoder = shape.decoder(Source::Body)?;
        let decoded = decoded.map(|decoded| shape.decoder_of(&decoded));
        let of_model = model.map(|model| shape.made_of(&model));
        let sent = sent.map(|name| shape.sent(&name)).transpose()?;
        Ok(quote!(#json #decoder #decoded #of_model #sent))
    })
}

/// Makes a shape that a client sends in a query: the parameters in the API document, and their decoder.
#[proc_macro_attribute]
pub fn params(_: TokenStream, item: TokenStream) -> TokenStream {
    expand(item, |shape| {
        let (visibility, attributes, name) = (&shape.input.vis, &shape.input.attrs, &shape.input.ident);
        let fields = shape.fields.iter().map(|field| field.declared(Source::Query));
        let decoder = shape.decoder(Source::Query)?;
        Ok(quote! {
            #[derive(Clone, Debug, PartialEq, Eq, utoipa::IntoParams)]
            #[into_params(parameter_in = Query)]
            #(#attributes)*
            #visibility struct #name { #(#fields,)* }
            #decoder
        })
    })
}

/// The type that is decoded from a shape.
struct Decoded {
    path: Path,
    is_checked: bool,
    is_same: bool,
}

impl Parse for Decoded {
    fn parse(input: ParseStream<'_>) -> syn::Result<Self> {
        let is_checked = input.parse::<Option<kw::checked>>()?.is_some();
        let is_same = input.parse::<Option<kw::same>>()?.is_some();
        Ok(Self { path: input.parse()?, is_checked, is_same })
    }
}

/// The types that a body is read into, made of and documented as.
#[derive(Default)]
struct Arguments {
    decoded: Option<Decoded>,
    model: Option<Type>,
    sent: Option<Ident>,
}

impl Parse for Arguments {
    fn parse(input: ParseStream<'_>) -> syn::Result<Self> {
        let mut arguments = Self::default();
        while !input.is_empty() {
            if input.parse::<Option<kw::of>>()?.is_some() {
                input.parse::<Token![=]>()?;
                arguments.model = Some(input.parse()?);
            } else if input.parse::<Option<kw::sent>>()?.is_some() {
                arguments.sent = Some(input.parse()?);
            } else {
                arguments.decoded = Some(input.parse()?);
            }
            input.parse::<Option<Token![,]>>()?;
        }
        Ok(arguments)
    }
}

mod kw {
    syn::custom_keyword!(checked);
    syn::custom_keyword!(of);
    syn::custom_keyword!(same);
    syn::custom_keyword!(sent);
}

/// A struct that is a shape.
struct Shape {
    input: DeriveInput,
    fields: Vec<Field>,
}

fn expand(item: TokenStream, write: impl FnOnce(&Shape) -> syn::Result<Tokens>) -> TokenStream {
    let written = syn::parse::<DeriveInput>(item).and_then(Shape::of).and_then(|shape| write(&shape));
    written.unwrap_or_else(syn::Error::into_compile_error).into()
}

impl Shape {
    fn of(input: DeriveInput) -> syn::Result<Self> {
        let Data::Struct(data) = &input.data else {
            return Err(syn::Error::new_spanned(&input, "a shape is a struct"));
        };
        let Fields::Named(named) = &data.fields else {
            return Err(syn::Error::new_spanned(&input, "a shape has named fields"));
        };
        let fields = named.named.iter().map(Field::of).collect::<syn::Result<_>>()?;
        Ok(Self { input, fields })
    }

    /// The struct, as JSON and as a schema.
    fn json(&self, strictness: &Tokens) -> Tokens {
        let (visibility, attributes, name) = (&self.input.vis, &self.input.attrs, &self.input.ident);
        let fields = self.fields.iter().map(|field| field.declared(Source::Body));
        quote! {
            #[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize, utoipa::ToSchema)]
            #strictness
            #(#attributes)*
            #visibility struct #name { #(#fields,)* }
        }
    }

    /// Returns what makes it of the model's type.
    fn made_of(&self, model: &Type) -> Tokens {
        let name = &self.input.ident;
        let is_borrowed = matches!(model, Type::Reference(_));
        let idents = self.fields.iter().map(Field::ident);
        let values = self.fields.iter().map(|field| field.shown(is_borrowed));
        quote! {
            impl From<#model> for #name {
                fn from(of: #model) -> Self {
                    Self { #(#idents: #values,)* }
                }
            }

            impl ::revisit_api::shown::Shown<#model> for #name {
                fn shown(of: #model) -> Self {
                    of.into()
                }
            }
        }
    }

    /// The reader of its fields.
    fn decoder(&self, source: Source) -> syn::Result<Tokens> {
        let name = &self.input.ident;
        let idents: Vec<_> = self.fields.iter().map(Field::ident).collect();
        let names = self.fields.iter().flat_map(Field::names);
        let readers =
            self.fields.iter().map(|field| field.reader(source)).collect::<syn::Result<Vec<_>>>()?;
        let parallel = self.fields.iter().filter_map(|second| {
            let first = self.fields.iter().find(|first| Some(first.ident()) == second.parallel_to())?;
            let (first, second) = (first.as_column(), second.as_column());
            Some(quote!(object.parallel(#first, #second)?;))
        });
        Ok(quote! {
            impl ::revisit_api::decoding::read::Members for #name {
                fn names() -> Vec<&'static str> {
                    vec![#(#names),*]
                }

                fn read(object: &::revisit_api::decoding::read::Object<'_>) -> Option<Self> {
                    #(let #idents = #readers;)*
                    #(#parallel)*
                    Some(Self { #(#idents: #idents?,)* })
                }
            }

            impl ::revisit_api::decoding::read::Decode for #name {
                fn decode(node: &::revisit_api::decoding::read::Node<'_>) -> Option<Self> {
                    ::revisit_api::decoding::read::members(node)
                }
            }
        })
    }

    /// The schema of what clients send, in which a column may be packed.
    fn sent(&self, name: &Ident) -> syn::Result<Tokens> {
        let visibility = &self.input.vis;
        let docs = self.input.attrs.iter().filter(|attribute| attribute.path().is_ident("doc"));
        let fields = self.fields.iter().map(Field::sent).collect::<syn::Result<Vec<_>>>()?;
        Ok(quote! {
            #(#docs)*
            #[doc = " Long lists may be packed."]
            #[derive(serde::Deserialize, utoipa::ToSchema)]
            #[serde(deny_unknown_fields)]
            #[schema(as = #name)]
            #visibility struct #name { #(#fields,)* }
        })
    }

    /// The decoder of the model's type.
    fn decoder_of(&self, Decoded { path: model, is_checked, is_same }: &Decoded) -> Tokens {
        let name = &self.input.ident;
        let idents = self.fields.iter().map(Field::ident);
        let same = is_same.then(|| {
            quote! {
                impl From<#name> for #model {
                    fn from(shape: #name) -> Self {
                        Self { #(#idents: shape.#idents,)* }
                    }
                }
            }
        });
        let made = if *is_checked { quote!(shape.checked(node)) } else { quote!(Some(shape.into())) };
        quote! {
            #same

            impl ::revisit_api::decoding::read::Decode for #model {
                fn decode(node: &::revisit_api::decoding::read::Node<'_>) -> Option<Self> {
                    let shape = <#name as ::revisit_api::decoding::read::Decode>::decode(node)?;
                    #made
                }
            }
        }
    }
}
