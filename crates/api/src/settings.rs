//! Settings: the table of `model::settings` as JSON, and as a schema with its defaults, bounds and meanings.

use revisit_core::domain::method::Method;
use revisit_core::domain::settings::{Setting, SettingError, SettingKind, SettingValue, Settings};
use revisit_core::semantics::Patterns;
use serde::Serialize;
use serde_json::{Map, Value, json};
use utoipa::openapi::extensions::ExtensionsBuilder;
use utoipa::openapi::schema::{AdditionalProperties, ArrayBuilder, ObjectBuilder, SchemaType, Type};
use utoipa::openapi::{RefOr, Schema};
use utoipa::{PartialSchema, ToSchema};

use super::decoding::read::{self, Decode, Node};
use super::limits;

/// The settings of a map, by name; in a request only those to be set.
#[derive(Clone, Debug, Default, PartialEq, Serialize, serde::Deserialize)]
#[serde(transparent)]
pub struct MapSettings(pub Map<String, Value>);

/// The setting that sets others with it.
const METHOD: &str = "method";

/// Settings to be set, checked one by one.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ChosenSettings(pub Vec<(String, SettingValue)>);

impl Decode for ChosenSettings {
    fn decode(node: &Node<'_>) -> Option<Self> {
        let names: Vec<&str> = Settings::TABLE.iter().map(|row| row.name).collect();
        let object = node.object(&names)?;
        let method = object.optional(METHOD, |node| node.choice(Method::NAMES, Method::from_name));
        let read: Vec<_> =
            Settings::TABLE.iter().map(|row| object.optional(row.name, |node| setting(node, row))).collect();
        let named: Option<Vec<_>> = read.into_iter().collect();
        let of_method = method?.into_iter().flat_map(Method::settings);
        let of_method = of_method.map(|(name, value)| (name.to_owned(), value));
        // What is named in the same body comes later, and so wins.
        Some(Self(of_method.chain(named?.into_iter().flatten()).collect()))
    }
}

fn setting(node: &Node<'_>, row: &Setting) -> Option<(String, SettingValue)> {
    let value = match row.kind {
        SettingKind::Number { .. } => SettingValue::Number(node.number(f64::MIN..=f64::MAX)?),
        SettingKind::Count { min, max, .. } => SettingValue::Count(node.count(min.into()..=max.into())?),
        SettingKind::Switch => SettingValue::Switch(read::switch(node)?),
        SettingKind::Choice { names, .. } => {
            let named = |text: &str| names.iter().copied().find(|name| *name == text);
            SettingValue::Choice(node.choice(names, named)?)
        }
        SettingKind::Patterns => SettingValue::Patterns(patterns(node)?),
    };
    match Settings::default().set(row.name, value.clone()) {
        Ok(()) => Some((row.name.to_owned(), value)),
        Err(error @ SettingError::Range { min, max }) => {
            node.refuse(error.to_string(), format!("[{min}, {max}]"))
        }
        Err(error) => node.refuse(error.to_string(), row.description()),
    }
}

fn patterns(node: &Node<'_>) -> Option<Patterns> {
    const LIMIT: &str = "regular expressions of 1 to 256 bytes";
    let texts = node.list(limits::PATTERNS, |item| item.text(limits::PATTERN_CHARS))?;
    let error = match Patterns::new(texts) {
        Ok(patterns) => return Some(patterns),
        Err(error) => error,
    };
    let Some(wrong) = error.at() else { return node.refuse(error.to_string(), LIMIT) };
    node.each(
        limits::PATTERNS,
        |at, item| if at == wrong { item.refuse(error.to_string(), LIMIT) } else { Some(()) },
    )?;
    None
}

impl From<&Settings> for MapSettings {
    fn from(settings: &Settings) -> Self {
        let shown = |row: &Setting| settings.get(row.name).map(|value| (row.name.to_owned(), json!(value)));
        Self(Settings::TABLE.iter().filter_map(shown).collect())
    }
}

impl MapSettings {
    /// Returns the settings that differ from their defaults.
    pub fn changed(settings: &Settings) -> Self {
        Self(settings.changed().map(|(name, value)| (name.to_owned(), json!(value))).collect())
    }
}

impl From<Vec<(String, SettingValue)>> for MapSettings {
    fn from(chosen: Vec<(String, SettingValue)>) -> Self {
        Self(chosen.into_iter().map(|(name, value)| (name, json!(value))).collect())
    }
}

impl ToSchema for MapSettings {
    fn name() -> std::borrow::Cow<'static, str> {
        "Settings".into()
    }
}

impl PartialSchema for MapSettings {
    fn schema() -> RefOr<Schema> {
        let object = ObjectBuilder::new()
            .schema_type(SchemaType::Type(Type::Object))
            .description(Some(
                "Every threshold of the method; the defaults are the paper's, where it has one.",
            ))
            .additional_properties(Some(AdditionalProperties::FreeForm(false)));
        Settings::TABLE.iter().fold(object, |object, row| object.property(row.name, row_schema(row))).into()
    }
}

fn row_schema(row: &Setting) -> RefOr<Schema> {
    let description = Some(row.description());
    let unit = row.unit.map(|unit| ExtensionsBuilder::new().add("x-unit", unit).build());
    let default = Some(json!(row.default));
    let schema =
        ObjectBuilder::new().description(description.clone()).extensions(unit).default(default.clone());
    let schema = match row.kind {
        SettingKind::Number { min, max } => {
            schema.schema_type(SchemaType::Type(Type::Number)).minimum(Some(min)).maximum(Some(max))
        }
        SettingKind::Count { min, max } => {
            schema.schema_type(SchemaType::Type(Type::Integer)).minimum(Some(min)).maximum(Some(max))
        }
        SettingKind::Switch => schema.schema_type(SchemaType::Type(Type::Boolean)),
        SettingKind::Choice { names } => {
            schema.schema_type(SchemaType::Type(Type::String)).enum_values(Some(names.iter().copied()))
        }
        SettingKind::Patterns => {
            let pattern = ObjectBuilder::new()
                .schema_type(SchemaType::Type(Type::String))
                .min_length(Some(1))
                .max_length(Some(limits::PATTERN_CHARS));
            let list = ArrayBuilder::new().items(pattern).max_items(Some(limits::PATTERNS));
            return list.description(description).default(default).into();
        }
    };
    schema.into()
}
