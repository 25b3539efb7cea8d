//! Overrides: settings of the recording's maps, changed for this replay.

use clap::Args;
use clap::builder::BoolishValueParser;
use serde_json::{Map, Value};

/// The settings to change, on the command line.
#[derive(Args, Clone, Debug, Default)]
pub struct Overrides {
    /// Use the paper's exact method: the setting method=paper
    #[arg(long, env = "REVISIT_PAPER", value_parser = BoolishValueParser::new())]
    pub paper: bool,
    /// Change a setting of every map of the recording; repeatable, overrides --paper
    #[arg(long = "set", env = "REVISIT_SET", value_name = "NAME=VALUE", value_delimiter = ',', value_parser = setting)]
    pub settings: Vec<(String, Value)>,
    /// Mark every distance as assumed: `"range":"assumed"` on each detection
    #[arg(long, env = "REVISIT_ASSUMED_RANGES", value_parser = BoolishValueParser::new())]
    pub assumed_ranges: bool,
}

/// Reads one `name=value`: the name in the API document, and a number, `true`, `false`, or else a string.
fn setting(text: &str) -> Result<(String, Value), String> {
    match text.split_once('=') {
        Some((name, value)) if !name.trim().is_empty() => {
            let read = serde_json::from_str(value);
            Ok((name.trim().to_owned(), read.unwrap_or_else(|_| Value::String(value.trim().to_owned()))))
        }
        _ => Err("expected name=value, say candidates_max=5".to_owned()),
    }
}

impl Overrides {
    /// Returns every changed setting with its value.
    pub(super) fn changes(&self) -> Map<String, Value> {
        let method = self.paper.then(|| ("method".to_owned(), Value::String("paper".to_owned())));
        method.into_iter().chain(self.settings.iter().cloned()).collect()
    }

    /// Changes the detections of a keyframe.
    pub(super) fn apply_to_keyframe(&self, body: &mut Map<String, Value>) {
        let Some(Value::Array(detections)) = body.get_mut("detections").filter(|_| self.assumed_ranges)
        else {
            return;
        };
        for detection in detections.iter_mut().filter_map(Value::as_object_mut) {
            detection.insert("range".to_owned(), Value::String("assumed".to_owned()));
        }
    }

    /// Changes the settings in the body of a map.
    pub(super) fn apply(&self, body: &mut Map<String, Value>) {
        let changes = self.changes();
        if changes.is_empty() {
            return;
        }
        match body.entry("settings").or_insert_with(|| Value::Object(Map::new())) {
            Value::Object(settings) => settings.extend(changes),
            // Settings that are not an object: nothing of the recording is worth keeping there.
            other => *other = Value::Object(changes),
        }
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn applied(paper: bool, set: &[&str], body: Value) -> Value {
        let settings = set.iter().map(|text| setting(text).expect("name=value"));
        let overrides = Overrides { paper, settings: settings.collect(), assumed_ranges: false };
        let Value::Object(mut body) = body else { panic!("a body is an object") };
        overrides.apply(&mut body);
        Value::Object(body)
    }

    #[test]
    fn without_overrides_a_body_stays_as_recorded() {
        assert_eq!(applied(false, &[], json!({})), json!({}));
    }

    #[test]
    fn values_keep_their_type_and_the_other_settings_stay() {
        let set = ["candidates_max=5", "building_repeats=false", "without_anchors=geometry"];
        assert_eq!(
            applied(false, &set, json!({"metric": true, "settings": {"candidates_max": 20, "x": 1}})),
            json!({"metric": true, "settings": {
                "candidates_max": 5, "x": 1, "building_repeats": false, "without_anchors": "geometry"}}),
        );
    }

    #[test]
    fn the_paper_is_a_method_and_what_is_set_goes_beside_it() {
        assert_eq!(
            applied(true, &["building_repeats=true"], json!({})),
            json!({"settings": {"method": "paper", "building_repeats": true}}),
        );
    }

    #[test]
    fn a_setting_without_a_name_or_a_value_is_refused() {
        for text in ["", "candidates_max", "=5"] {
            assert!(setting(text).is_err(), "{text:?} was taken");
        }
    }
}
