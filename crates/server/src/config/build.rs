//! Build: the name, version and missing features of this binary.

/// The program's name.
pub const NAME: &str = "revisit";
/// The program's version.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");

/// The version of SQLite inside it.
pub const SQLITE: &str = match libsqlite3_sys::SQLITE_VERSION.to_str() {
    Ok(version) => version,
    Err(_) => "unknown",
};

/// Environment variables of optional features: the feature, whether it is built in, and its variables.
const OPTIONAL: [(&str, bool, &[&str]); 2] = [
    (
        "llm",
        cfg!(feature = "llm"),
        &[
            "REVISIT_MODEL_URL",
            "REVISIT_MODEL_VISION_URL",
            "REVISIT_MODEL_EMBEDDINGS_URL",
            "REVISIT_MODEL_KIND",
            "REVISIT_READER",
        ],
    ),
    ("otel", cfg!(feature = "otel"), &["REVISIT_OTLP_ENDPOINT"]),
];

/// Returns why this build cannot satisfy the environment. Otherwise a configured but missing model would go unnoticed.
pub fn missing_feature() -> Option<String> {
    missing(&OPTIONAL, |variable| std::env::var_os(variable).is_some_and(|value| !value.is_empty()))
}

fn missing(optional: &[(&str, bool, &[&str])], is_set: impl Fn(&str) -> bool) -> Option<String> {
    let mut left_out = optional.iter().filter(|(_, is_in, _)| !is_in);
    left_out.find_map(|(feature, _, variables)| {
        let variable = variables.iter().find(|variable| is_set(variable))?;
        Some(format!("{variable} is set, but this program was built without the feature `{feature}`"))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_variable_of_a_feature_that_was_left_out_is_named() {
        let optional: [(&str, bool, &[&str]); 2] = [("in", true, &["A"]), ("out", false, &["B", "C"])];
        let reason = missing(&optional, |variable| variable != "B").expect("C is set");
        assert!(reason.starts_with("C is set") && reason.ends_with("`out`"), "{reason}");
        assert_eq!(missing(&optional, |variable| variable == "A"), None);
    }
}
