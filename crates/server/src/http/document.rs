//! Document: the API document, built from the routes themselves.

use serde_json::json;
use utoipa::OpenApi;
use utoipa::openapi::extensions::ExtensionsBuilder;
use utoipa::openapi::path::{Operation, Parameter, PathItem};
use utoipa::openapi::schema::{Object, OneOf, SchemaType, Type};
use utoipa::openapi::security::{Http, HttpAuthScheme, SecurityRequirement, SecurityScheme};
use utoipa::openapi::{RefOr, Schema};

use super::guards::route_permissions::SCHEME;
use super::{error_responses, routes};
use crate::api::event::EventView;
use crate::api::problem::ProblemView;
use crate::recognition::constants::{self, Constant};

#[derive(OpenApi)]
#[openapi(
    info(
        title = "Revisit",
        description = "Semantic place recognition: is this keyframe a loop?\n\nClients choose ids and write by \
            `PUT`, so retries are safe. Every response of 400 and above is `application/problem+json` and \
            lists all faults of the request. Lengths are in metres, angles in radians, image coordinates in pixels. \
            An optional field is omitted, never null. Bytes inside JSON are base64 \
            (RFC 4648, section 4), with or without padding.\n\nAnswers about a map say its `map_version`. A request that reads a map may \
            say which version its client has seen, as the header `x-revisit-min-version` or the parameter `min_version`: the answer \
            is not older, whichever server gives it. A map that does not have the version within two seconds is answered with \
            412.\n\nNumbers that affect verdicts are a map's settings, or constants, which \
            this document lists under `x-constants`.",
        license(name = "MIT OR Apache-2.0", identifier = "MIT OR Apache-2.0")
    ),
    servers(
        (url = "/", description = "The server of this document"),
        (url = "http://127.0.0.1:7878", description = "`revisit serve` on this machine, by default")
    ),
    tags(
        (name = "maps", description = "A map and its settings"),
        (name = "releases", description = "Named versions of a map that stay as they are, for robots to ask"),
        (name = "keyframes", description = "Store keyframes, individually or in bulk"),
        (name = "loops", description = "Loop queries and confirmed loops. A verdict does not close a \
            loop: nothing changes until the client confirms one"),
        (name = "anchors", description = "Semantic anchors: their readings, positions and matches"),
        (name = "events", description = "Changes of a map, as a stream"),
        (name = "semantics", description = "The three functions of §IV-A.2, and the cost of models"),
        (name = "service", description = "State of the server"),
        (name = "keys", description = "API keys. From the first one on, every request needs a key: create the administrator's first")
    ),
    components(schemas(ProblemView, EventView))
)]
struct Frame;

/// Returns the document without its operations.
pub fn frame() -> utoipa::openapi::OpenApi {
    let mut document = Frame::openapi();
    let mut bearer = Http::new(HttpAuthScheme::Bearer);
    bearer.description = Some(
        "An API key with the action that the operation requires. A server on loopback whose database never had a key \
         requires none."
            .to_owned(),
    );
    document.components.get_or_insert_default().add_security_scheme(SCHEME, SecurityScheme::Http(bearer));
    document
}

/// Returns the API document.
pub fn document() -> utoipa::openapi::OpenApi {
    let (_, mut document) = routes::api(frame()).split_for_parts();
    if let Some(components) = &mut document.components {
        components.responses.extend(error_responses::components());
        components.schemas.values_mut().for_each(settle);
    }
    document.paths.paths.values_mut().flat_map(operations).for_each(|operation| {
        if wants_key(operation) {
            operation.responses.responses.extend(error_responses::of_keys());
        }
        for parameter in operation.parameters.iter_mut().flatten() {
            if let RefOr::T(Parameter { schema: Some(schema), .. }) = parameter {
                refuse_null(schema);
            }
        }
    });
    document.extensions = Some(ExtensionsBuilder::new().add("x-constants", constants()).build());
    document
}

/// Returns the constants that affect verdicts and are not settings.
fn constants() -> Vec<serde_json::Value> {
    let shown = |constant: &Constant| {
        let Constant { name, value, unit, doc } = constant;
        json!({"name": name, "value": value, "unit": unit, "description": doc})
    };
    constants::constants().map(shown).collect()
}

/// Whether the operation requires a key with an action.
fn wants_key(operation: &Operation) -> bool {
    operation.security.iter().flatten().any(|requirement| *requirement != SecurityRequirement::default())
}

fn operations(item: &mut PathItem) -> impl Iterator<Item = &mut Operation> {
    let PathItem { get, put, post, patch, delete, .. } = item;
    [get, put, post, patch, delete].into_iter().flatten()
}

/// Removes null from optional fields, which this API omits instead. This also removes every `oneOf`: utoipa writes it
/// for "this schema or null", and C++ generators fail on it.
fn settle(schema: &mut RefOr<Schema>) {
    let RefOr::T(Schema::Object(object)) = schema else { return };
    let Object { properties, required, .. } = object;
    for (name, property) in properties {
        if !required.contains(name) {
            refuse_null(property);
        }
        settle(property);
    }
}

fn refuse_null(property: &mut RefOr<Schema>) {
    match property {
        RefOr::T(Schema::Object(object)) => only(&mut object.schema_type),
        RefOr::T(Schema::Array(array)) => only(&mut array.schema_type),
        RefOr::T(Schema::OneOf(OneOf { items, description, .. })) => {
            let Some(mut inner) = items.iter().find(|item| !is_null(item)).cloned() else { return };
            if let Some(description) = description.take() {
                match &mut inner {
                    RefOr::Ref(reference) => reference.description = description,
                    RefOr::T(Schema::Array(array)) => array.description = Some(description),
                    RefOr::T(_) => {}
                }
            }
            *property = inner;
        }
        _ => {}
    }
}

/// Reduces "this type or null" to this type.
fn only(kind: &mut SchemaType) {
    if let SchemaType::Array(kinds) = kind {
        kinds.retain(|kind| *kind != Type::Null);
        if let [one] = kinds.as_slice() {
            *kind = SchemaType::Type(one.clone());
        }
    }
}

fn is_null(schema: &RefOr<Schema>) -> bool {
    match schema {
        RefOr::T(Schema::Object(object)) => object.schema_type == SchemaType::Type(Type::Null),
        _ => false,
    }
}
