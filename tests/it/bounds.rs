//! Bounds: what the API document promises of a body, the server's reader holds it to, field by field.

use revisit::api::anchor::AnchorPatchBody;
use revisit::api::decoding::document::Document;
use revisit::api::decoding::{read, syntax};
use revisit::api::semantics::{OneText, TextPair};
use revisit::api::settings::MapSettings;
use revisit::api::{examples, keyframe};
use revisit::domain::invalid::FieldError;
use revisit::domain::request::{ChangedObservations, LoopQuery, MapPatch, NewLoop, NewMap, PoseCorrection};
use revisit::domain::settings::Settings;
use revisit::http::document;
use serde_json::{Value, json};

type Read<'r> = &'r dyn Fn(&Value) -> Vec<FieldError>;

/// A schema, a body of that schema with every field in it, and the reader of such bodies.
struct Probe<'p> {
    document: &'p Value,
    body: &'p Value,
    read: Read<'p>,
}

impl Probe<'_> {
    /// The places at fault once the value at a place is another one.
    fn faults(&self, place: &str, value: Value) -> Vec<String> {
        let mut body = self.body.clone();
        *body.pointer_mut(place).expect("a place of the example") = value;
        (self.read)(&body).into_iter().map(|error| error.pointer).collect()
    }

    #[track_caller]
    fn refuses(&self, place: &str, value: Value, told: &str) {
        let shown: String = value.to_string().chars().take(80).collect();
        let faults = self.faults(place, value);
        assert!(
            faults.iter().any(|fault| fault == told),
            "{told} takes {shown}, against the document: {faults:?}"
        );
    }

    #[track_caller]
    fn takes(&self, place: &str, value: Value) {
        let shown = value.to_string();
        let faults = self.faults(place, value);
        assert!(
            !faults.iter().any(|fault| fault == place),
            "{place} refuses {shown}, which the document allows"
        );
    }

    fn check(&self, place: &str, schema: &Value) {
        let schema = self.resolve(schema);
        let here = self.body.pointer(place).unwrap_or_else(|| panic!("the example has no {place}"));
        match schema["type"].as_str() {
            Some("object") => self.check_object(place, schema, here),
            Some("array") => self.check_list(place, schema, here),
            Some("number" | "integer") => self.check_number(place, schema),
            Some("boolean") => self.refuses(place, json!("true"), place),
            _ => self.check_text(place, schema),
        }
    }

    fn resolve<'s>(&'s self, schema: &'s Value) -> &'s Value {
        match schema["$ref"].as_str().and_then(|reference| reference.strip_prefix('#')) {
            Some(pointer) => self.document.pointer(pointer).expect("a schema"),
            None => schema,
        }
    }

    fn check_object(&self, place: &str, schema: &Value, here: &Value) {
        self.refuses(place, json!("text"), place);
        assert_eq!(schema["additionalProperties"], false, "{place} takes any field");
        let mut more = here.clone();
        more["no_such_field"] = json!(1);
        self.refuses(place, more, &format!("{place}/no_such_field"));
        for name in schema["required"].as_array().into_iter().flatten().filter_map(Value::as_str) {
            let mut less = here.clone();
            less.as_object_mut().map(|members| members.remove(name));
            self.refuses(place, less, &format!("{place}/{name}"));
        }
        for (name, schema) in schema["properties"].as_object().expect("properties") {
            if here.get(name).is_some() {
                self.check(&format!("{place}/{name}"), schema);
            }
        }
    }

    fn check_list(&self, place: &str, schema: &Value, here: &Value) {
        self.refuses(place, json!({}), place);
        let most = schema["maxItems"].as_u64().unwrap_or_else(|| panic!("{place} has no bound")) as usize;
        self.refuses(place, json!(vec![&here[0]; most + 1]), place);
        if let Some(least) = schema["minItems"].as_u64() {
            self.refuses(place, json!(vec![&here[0]; least as usize - 1]), place);
        }
        self.check(&format!("{place}/0"), &schema["items"]);
    }

    fn check_number(&self, place: &str, schema: &Value) {
        self.refuses(place, json!("1"), place);
        if schema["type"] == "integer" {
            self.refuses(place, json!(8.5), place);
        }
        for (bound, beyond) in [("minimum", -1.0), ("maximum", 1.0)] {
            if let Some(edge) = schema[bound].as_f64() {
                self.takes(place, schema[bound].clone());
                self.refuses(place, json!(edge + beyond * edge.abs().max(1.0)), place);
            }
        }
        if let Some(step) = schema["multipleOf"].as_i64() {
            self.refuses(place, json!(step + 1), place);
        }
    }

    fn check_text(&self, place: &str, schema: &Value) {
        self.refuses(place, json!(1), place);
        if schema["enum"].is_array() {
            return self.refuses(place, json!("none of these"), place);
        }
        let most = schema["maxLength"].as_u64().unwrap_or_else(|| panic!("{place} has no bound"));
        self.refuses(place, json!("x".repeat(most as usize + 1)), place);
        if schema["minLength"].as_u64().is_some_and(|least| least > 0) {
            self.refuses(place, json!(""), place);
        }
    }
}

#[track_caller]
fn check(schema: &str, body: &Value, read: Read<'_>) {
    let document = serde_json::to_value(document()).expect("JSON");
    assert!(read(body).is_empty(), "{schema}: {:?}", read(body));
    Probe { document: &document, body, read }.check("", &document["components"]["schemas"][schema]);
}

fn parsed(body: &Value) -> Document<'static> {
    syntax::parse(body.to_string().leak().as_bytes()).expect("JSON")
}

fn faults<T: read::Decode>(body: &Value) -> Vec<FieldError> {
    read::decode::<T>(&parsed(body)).err().unwrap_or_default()
}

#[test]
fn a_keyframe_is_held_to_the_document() {
    let id = "kf-120".parse().expect("an id");
    check("Keyframe", &examples::keyframe_body(), &|body| {
        keyframe::named(parsed(body).root(), &id).err().unwrap_or_default()
    });
}

#[test]
fn a_map_is_held_to_the_document_with_every_setting() {
    let mut body = examples::map_body();
    body["settings"] = json!(MapSettings::from(&Settings::default()));
    body["settings"]["identifier_patterns"] = json!(["[0-9]+"]);
    check("MapBody", &body, &faults::<NewMap>);
    check("MapPatchBody", &body, &faults::<MapPatch>);
}

#[test]
fn the_other_bodies_are_held_to_the_document() {
    check("LoopQueryBody", &examples::loop_query(), &faults::<LoopQuery>);
    check("LoopQueryBody", &json!({"inline": examples::keyframe_body()}), &faults::<LoopQuery>);
    check("LoopBody", &examples::loop_body(), &faults::<NewLoop>);
    check("ObservationsBody", &examples::observations_body(), &faults::<ChangedObservations>);
    check("PosesBody", &examples::poses_body(), &faults::<PoseCorrection>);
    check("AnchorPatchBody", &examples::anchor_patch(), &faults::<AnchorPatchBody>);
    check("TextPair", &examples::text_pair(), &faults::<TextPair>);
    check("OneText", &examples::one_text(), &faults::<OneText>);
}
